"""Pictures of a sequence as the viewer of a page reads them: layers chosen at first, and data URLs."""

import base64
from typing import NamedTuple

from moseg.workflows.reports.content import Layer, LayerKind, Picture, SequencePanel


class Choice(NamedTuple):
    """Layers that a pane shows at first: the number of one base, and numbers of those over it."""

    base: int | None
    over: frozenset[int]


class Viewer(NamedTuple):
    """The viewer of a sequence.

    Attributes
    ----------
    panes : tuple of Choice
        Of the left and the right pane.
    still : int
        Place among the shown frames of the one that is shown first.
    still_pictures : tuple of (str, str)
        Layer's name and data URL, base first: what a reader without scripts sees.
    data : dict
        For the script, as JSON: ``frames``, ``fps`` (frames of the sequence in a second of the video), and ``layers``
        with a data URL for each frame.
    """

    panes: tuple[Choice, ...]
    still: int
    still_pictures: tuple[tuple[str, str], ...]
    data: dict


def data_url(picture: Picture) -> str:
    """Return a picture as a URL that contains it."""
    return f"data:{picture.media_type};base64,{encode_base64(picture.data)}"


def encode_base64(data: bytes) -> str:
    """Return bytes as base64."""
    return base64.b64encode(data).decode()


def choose_panes(layers: tuple[Layer, ...]) -> tuple[Choice, ...]:
    """Choose the layers of the left pane, which are shown at first, and of the right pane, which lie beside."""
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


def gather_viewer(panel: SequencePanel) -> Viewer | None:
    """Return the viewer of a sequence; None where it has no pictures."""
    panes = choose_panes(panel.layers) if panel.frames else ()
    if not panes:
        return None
    left = panes[0]
    still = _choose_still(panel, left)
    layers = [
        {"name": layer.name, "pictures": [picture and data_url(picture) for picture in layer.pictures]}
        for layer in panel.layers
    ]
    first = [layers[number] for number in [*([] if left.base is None else [left.base]), *sorted(left.over)]]
    return Viewer(
        panes=panes,
        still=still,
        still_pictures=tuple((each["name"], url) for each in first if (url := each["pictures"][still]) is not None),
        data={
            "frames": panel.frames,
            "fps": panel.video.fps * panel.video.step if panel.video else None,
            "layers": layers,
        },
    )


def _choose_still(panel: SequencePanel, choice: Choice) -> int:
    """Return the place of the shown frame nearest to the middle that has a picture of the pane's base."""
    middle = len(panel.frames) // 2
    if choice.base is None:
        return middle
    pictures = panel.layers[choice.base].pictures
    known = [place for place, picture in enumerate(pictures) if picture is not None]
    return min(known, key=lambda place: abs(place - middle), default=middle)
