"""A sequence as a page shows it: its pictures as data, its panels as tables and plots."""

import base64
from typing import NamedTuple

from moseg.workflows.reports.content import GroupedObject, SequencePanel, VariantPanel
from moseg.workflows.reports.page.eigenvalue_plots import Plot, gather_plot
from moseg.workflows.reports.page.heat_maps import HeatMap, gather_heat_map
from moseg.workflows.reports.picture_content import Layer, LayerKind, Picture


class Choice(NamedTuple):
    """Which layers a pane shows at first: the number of one base, and numbers of those over it."""

    base: int | None
    over: frozenset[int]


class MotionGroup(NamedTuple):
    """Objects that move as one; motion 0 is the background's."""

    motion: int
    members: tuple[GroupedObject, ...]


class VariantView(NamedTuple):
    """A variant of a sequence: its matrices and plot as drawn, and its groups of motions."""

    panel: VariantPanel
    groups: tuple[MotionGroup, ...]
    heat_maps: tuple[HeatMap, ...]
    plot: Plot | None


class SequenceView(NamedTuple):
    """A sequence of a page.

    Attributes
    ----------
    number : int
        Its place on the page.
    panel : SequencePanel
    panes : tuple of Choice
        Of the left and the right pane; empty where there is no picture.
    still : int
        Place among the shown frames of the one that is seen first.
    still_pictures : tuple of (str, str)
        Layer's name and data URL, base first: what a reader without scripts sees.
    pictures : dict
        For the viewer, as JSON: ``frames``, ``fps`` (frames of the sequence in a second of the video), and ``layers``
        with a data URL for each frame.
    video : str or None
        Base64 of the MP4.
    variants : tuple of VariantView
    """

    number: int
    panel: SequencePanel
    panes: tuple[Choice, ...]
    still: int
    still_pictures: tuple[tuple[str, str], ...]
    pictures: dict
    video: str | None
    variants: tuple[VariantView, ...]


def data_url(picture: Picture) -> str:
    """A picture as an address that holds it."""
    return f"data:{picture.media_type};base64,{base64.b64encode(picture.data).decode()}"


def choose_panes(layers: tuple[Layer, ...]) -> tuple[Choice, ...]:
    """The left pane shows what the report wants shown; the right one what is for beside."""
    if not layers:
        return ()
    bases = [number for number, layer in enumerate(layers) if layer.kind is LayerKind.BASE]
    overs = [number for number, layer in enumerate(layers) if layer.kind is LayerKind.OVER]
    base = next((number for number in bases if layers[number].is_shown), bases[0] if bases else None)
    left = frozenset(number for number in overs if layers[number].is_shown)
    rest = [number for number in overs if number not in left]
    beside = [number for number in rest if layers[number].is_beside]
    if rest:
        return Choice(base, left), Choice(base, frozenset((beside or rest)[:1]))
    other = next((number for number in bases if number != base), base)
    return Choice(base, left), Choice(other, frozenset())


def _still(panel: SequencePanel, choice: Choice) -> int:
    """The shown frame nearest to the middle of which the left pane's base has a picture."""
    middle = len(panel.frames) // 2
    if choice.base is None:
        return middle
    pictures = panel.layers[choice.base].pictures
    known = [place for place, picture in enumerate(pictures) if picture is not None]
    return min(known, key=lambda place: abs(place - middle), default=middle)


def _gather_variant(panel: VariantPanel) -> VariantView:
    members: dict[int, list[GroupedObject]] = {}
    for each in panel.objects:
        members.setdefault(each.motion, []).append(each)
    return VariantView(
        panel=panel,
        groups=tuple(MotionGroup(motion, tuple(members[motion])) for motion in sorted(members)),
        heat_maps=tuple(gather_heat_map(matrix) for matrix in panel.matrices),
        plot=None if panel.eigenvalues is None else gather_plot(panel.eigenvalues),
    )


def gather_sequence(number: int, panel: SequencePanel) -> SequenceView:
    """What a page shows of its sequence of that number."""
    panes = choose_panes(panel.layers) if panel.frames else ()
    still = _still(panel, panes[0]) if panes else 0
    first = [] if not panes else [*([] if panes[0].base is None else [panes[0].base]), *sorted(panes[0].over)]
    layers = [
        {"name": layer.name, "pictures": [picture and data_url(picture) for picture in layer.pictures]}
        for layer in panel.layers
    ]
    return SequenceView(
        number=number,
        panel=panel,
        panes=panes,
        still=still,
        still_pictures=tuple(
            (layers[layer]["name"], url) for layer in first if (url := layers[layer]["pictures"][still]) is not None
        ),
        pictures={
            "frames": panel.frames,
            "fps": panel.video.fps * panel.video.step if panel.video else None,
            "layers": layers,
        },
        video=base64.b64encode(panel.video.data).decode() if panel.video else None,
        variants=tuple(map(_gather_variant, panel.variants)),
    )


def list_missing(panels: tuple[SequencePanel, ...]) -> tuple[tuple[int, str, tuple[str, ...]], ...]:
    """Of each sequence that lacks something: its number, its name, and what is missing and why."""
    rows = []
    for number, panel in enumerate(panels):
        of_variants = (f"{variant.variant}: {text}" for variant in panel.variants for text in variant.missing)
        texts = tuple(dict.fromkeys([*panel.missing, *of_variants]))
        if texts:
            rows.append((number, panel.name, texts))
    return tuple(rows)
