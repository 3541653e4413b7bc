"""Hopkins155 (Tron and Vidal 2007), its twelve sequences with missing data, and MTPV62 (Li et al. 2013)."""

from moseg.workflows.datasets.labelled_tracks import STRUCT_LAYOUT, TRACKS_SUFFIX, TRUTH_SUFFIX, LabelledTracks

PARTS = ("", "_g12", "_g13", "_g23")
"""Ends of the names of a sequence of three motions and of its parts, each without one of the motions."""
CHECKERBOARD = """
1R2RC 1R2RCR 1R2RCT_A 1R2RCT_B 1R2TCR 1R2TCRT 1RT2RCR 1RT2RCRT 1RT2RTCRT_A 1RT2RTCRT_B 1RT2TC 1RT2TCRT_A 1RT2TCRT_B
2R3RTC 2R3RTCRT 2RT3RC 2RT3RCR 2RT3RCT_A 2RT3RCT_B 2RT3RTCRT 2T3RCR 2T3RCRT 2T3RCRTP 2T3RCTP 2T3RTCR three-cars
"""
TRAFFIC = "cars2B cars2_06 cars2_07 cars3 cars5 cars9 cars10"
TRAFFIC_OF_TWO = "cars1 cars2 cars4 cars6 cars7 cars8 kanatani1 kanatani2 truck1 truck2"
ARTICULATED = "articulated two_cranes"
ARTICULATED_OF_TWO = "arm head kanatani3 people1 people2"
OF_FIVE = "dancing"
"""Sequence of five motions that the archive has and papers leave out."""
MISSING = "oc1R2RC oc1R2RCT oc2R3RCRT"
HOPKINS50 = " ".join((CHECKERBOARD, TRAFFIC, TRAFFIC_OF_TWO, ARTICULATED, ARTICULATED_OF_TWO)).split()
"""Sequences of which none is a part of another."""
MTPV = "Boat Bus Girl Man Swing"


def _with_parts(names: str) -> tuple[str, ...]:
    return tuple(name + part for name in names.split() for part in PARTS)


HOPKINS155 = LabelledTracks(
    name="hopkins155",
    official=(
        *_with_parts(CHECKERBOARD),
        *_with_parts(TRAFFIC),
        *TRAFFIC_OF_TWO.split(),
        *_with_parts(ARTICULATED),
        *ARTICULATED_OF_TWO.split(),
        OF_FIVE,
    ),
    suffix=TRUTH_SUFFIX,
    tree=f"<sequence>/<sequence>{TRUTH_SUFFIX}, each with y (3, N, F) homogeneous xy in px and s (N)",
    source="http://www.vision.jhu.edu/data/hopkins155/",
)
HOPKINS12 = LabelledTracks(
    name="hopkins12",
    official=_with_parts(MISSING),
    suffix=TRACKS_SUFFIX,
    tree=f"<sequence>_Tracks/<sequence>{TRACKS_SUFFIX}, each {STRUCT_LAYOUT}",
    source="the additional sequences with missing data of http://www.vision.jhu.edu/data/hopkins155/",
)
MTPV62 = LabelledTracks(
    name="mtpv62",
    official=(*(f"Hopkins50_{name}" for name in HOPKINS50), *(f"MTPV_data_{name}" for name in MTPV.split())),
    suffix=TRACKS_SUFFIX,
    tree=f"<sequence>_Tracks/<sequence>{TRACKS_SUFFIX}, each {STRUCT_LAYOUT}",
    source="http://perception.i2r.a-star.edu.sg",
)
