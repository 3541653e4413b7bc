"""Hopkins155, Hopkins12 and MTPV62: trajectories of rigid bodies, in few sequences of articulated ones.

Hopkins155 (Tron and Vidal 2007) has sequences of two and three motions. A sequence whose name ends in ``_g12``,
``_g13`` or ``_g23`` is a part of another one, with two of its three motions. The archive has 156 sequences, of which
papers report 155: they leave out ``dancing``, which has five motions. Hopkins12 was added later and has missing data.
MTPV62 (Li et al. 2013) is the 50 sequences of Hopkins155 that are not part of another, and twelve that have strong
perspective and missing data.

References
----------
R. Tron and R. Vidal, "A benchmark for the comparison of 3-D motion segmentation algorithms", CVPR 2007.
Z. Li, J. Guo, L.-F. Cheong and S. Z. Zhou, "Perspective motion segmentation via collaborative clustering", ICCV 2013.
"""

from itertools import chain

from moseg.workflows.datasets.labelled_tracks import (
    STRUCT_LAYOUT,
    TRACKS_SUFFIX,
    TRUTH_SUFFIX,
    VARIABLES_LAYOUT,
    LabelledTracks,
    NamedGroup,
)
from moseg.workflows.sources.files import natural_key


def _split(names: str) -> tuple[str, ...]:
    return tuple(names.split())


_THREE_CHECKERBOARD = _split("""
1R2RC 1R2RCR 1R2RCT_A 1R2RCT_B 1R2TCR 1R2TCRT 1RT2RCR 1RT2RCRT 1RT2RTCRT_A 1RT2RTCRT_B 1RT2TC 1RT2TCRT_A 1RT2TCRT_B
2R3RTC 2R3RTCRT 2RT3RC 2RT3RCR 2RT3RCT_A 2RT3RCT_B 2RT3RTCRT 2T3RCR 2T3RCRT 2T3RCRTP 2T3RCTP 2T3RTCR three-cars
""")
_THREE_TRAFFIC = _split("cars2B cars2_06 cars2_07 cars3 cars5 cars9 cars10")
_TWO_TRAFFIC = _split("cars1 cars2 cars4 cars6 cars7 cars8 kanatani1 kanatani2 truck1 truck2")
_THREE_ARTICULATED = _split("articulated two_cranes")
_TWO_ARTICULATED = _split("arm head kanatani3 people1 people2")
_THREE_MISSING = _split("oc1R2RC oc1R2RCT oc2R3RCRT")
_FIVE = "dancing"
_MTPV = _split("Boat Bus Girl Man Monk Raffles Swing Van")
_PERSPECTIVE = _split("boxes deliveryvan flowershirt lightbulb")

Categories = dict[str, tuple[str, ...]]
"""Sequences by category."""
_HOPKINS_URL = "http://www.vision.jhu.edu/data/hopkins155/"
_STRUCTS_URL = "https://github.com/jiangyangby/AAAI21-ConsistentMoSeg (code/Data)"


def _parts(sequences: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"{name}_{part}" for name in sequences for part in ("g12", "g13", "g23"))


def _motion_groups(two: Categories, three: Categories) -> tuple[NamedGroup, ...]:
    """Return each category of two and of three motions, each number of motions, each category, and all."""
    groups = []
    for number, categories in (("two motions", two), ("three motions", three)):
        groups.extend(NamedGroup(f"{number}, {name}", members) for name, members in categories.items())
        groups.append(NamedGroup(number, tuple(chain(*categories.values()))))
    groups.extend(NamedGroup(name, (*two[name], *three[name])) for name in two)
    return (*groups, NamedGroup("two and three motions", tuple(chain(*two.values(), *three.values()))))


_TWO = {
    "checkerboard": _parts(_THREE_CHECKERBOARD),
    "traffic": _parts(_THREE_TRAFFIC) + _TWO_TRAFFIC,
    "articulated": _parts(_THREE_ARTICULATED) + _TWO_ARTICULATED,
}
_THREE = {"checkerboard": _THREE_CHECKERBOARD, "traffic": _THREE_TRAFFIC, "articulated": _THREE_ARTICULATED}
_HOPKINS_GROUPS = _motion_groups(_TWO, _THREE)

_ALL_HOPKINS = (*_HOPKINS_GROUPS[-1].sequences, _FIVE)
_WHOLE = [name for name in _ALL_HOPKINS if name != _FIVE and name[-4:] not in ("_g12", "_g13", "_g23")]
_COMPLETE = tuple(f"Hopkins50_{name}" for name in sorted(_WHOLE, key=natural_key))
_HIDDEN = (*(f"MTPV_data_{name}" for name in _MTPV), *(f"PerspectiveNViewsData_{name}" for name in _PERSPECTIVE))

HOPKINS155 = LabelledTracks(
    name="hopkins155",
    official=tuple(sorted(_ALL_HOPKINS, key=natural_key)),
    suffixes=(TRUTH_SUFFIX,),
    tree=f"<sequence>/<sequence>{TRUTH_SUFFIX}, each with {VARIABLES_LAYOUT}",
    source=_HOPKINS_URL,
    groups=_HOPKINS_GROUPS,
)
HOPKINS12 = LabelledTracks(
    name="hopkins12",
    official=tuple(sorted(_THREE_MISSING + _parts(_THREE_MISSING), key=natural_key)),
    suffixes=(TRACKS_SUFFIX, TRUTH_SUFFIX),
    tree=(
        f"<sequence>_Tracks/<sequence>{TRACKS_SUFFIX}, each {STRUCT_LAYOUT}; "
        f"or <sequence>/<sequence>{TRUTH_SUFFIX}, each with {VARIABLES_LAYOUT}, and m (N, F) where points are visible"
    ),
    source=f"{_HOPKINS_URL} (additional sequences, missing data), or {_STRUCTS_URL}",
    groups=(
        NamedGroup("two motions", _parts(_THREE_MISSING)),
        NamedGroup("three motions", _THREE_MISSING),
        NamedGroup("all", (*_parts(_THREE_MISSING), *_THREE_MISSING)),
    ),
)
MTPV62 = LabelledTracks(
    name="mtpv62",
    official=(*_COMPLETE, *_HIDDEN),
    suffixes=(TRACKS_SUFFIX,),
    tree=f"<sequence>_Tracks/<sequence>{TRACKS_SUFFIX}, each {STRUCT_LAYOUT}, which is 0 for an outlier",
    source=_STRUCTS_URL,
    groups=(
        NamedGroup("complete data", _COMPLETE),
        NamedGroup("missing data", _HIDDEN),
        NamedGroup("all", (*_COMPLETE, *_HIDDEN)),
    ),
)
