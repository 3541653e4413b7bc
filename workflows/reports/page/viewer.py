"""Pictures of a sequence as the viewer of a page reads them: layers chosen at first, and data URLs."""

import base64
import re
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
    frames : tuple of int
        Frames that the slider reaches, in order: those with pictures, and those of the video or of the masks.
    still : int
        Place among them of the one that is shown first, which has pictures.
    still_pictures : tuple of (str, str)
        Layer's name and data URL, base first: what a reader without scripts sees.
    data : dict
        For the script, as JSON: ``frames``, those with pictures (``pictured``), ``fps`` (frames of the sequence in a
        second of the video), ``layers`` with a data URL for each frame with pictures, and for the masks their file
        (``archive``) and their ``places`` in it.
    """

    panes: tuple[Choice, ...]
    frames: tuple[int, ...]
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
    frames = reachable_frames(panel)
    layers = [
        {"name": layer.name, "pictures": [picture and data_url(picture) for picture in layer.pictures]}
        for layer in panel.layers
    ]
    first = [layers[number] for number in [*([] if left.base is None else [left.base]), *sorted(left.over)]]
    return Viewer(
        panes=panes,
        frames=frames,
        still=frames.index(panel.frames[still]),
        still_pictures=tuple((each["name"], url) for each in first if (url := each["pictures"][still]) is not None),
        data={
            "frames": frames,
            "pictured": panel.frames,
            "fps": panel.video.fps * panel.video.step if panel.video else None,
            "layers": layers,
            "archive": archive_name(panel.name),
            "places": panel.masks.places if panel.masks else (),
        },
    )


def reachable_frames(panel: SequencePanel) -> tuple[int, ...]:
    """Return the frames that the page can show: those with pictures of layers, those of the video, and the masks'."""
    in_video = range(0, panel.num_frames, panel.video.step) if panel.video else ()
    masked = (frame for frame, _, _ in panel.masks.places) if panel.masks else ()
    return tuple(sorted({*panel.frames, *in_video, *masked}))


def describe_reach(panel: SequencePanel, frames: tuple[int, ...]) -> str:
    """Return a sentence on the frames of the slider: which of them have pictures, and which it skips."""
    num_shown, num_pictured = len(frames), len(panel.frames)
    if num_shown == panel.num_frames:
        reach = "The slider has every frame."
    else:
        skipped = panel.num_frames - num_shown
        reach = f"The slider has {num_shown} of {panel.num_frames} frames and skips {skipped}."
    if num_shown == num_pictured:
        return reach
    beside = " and ".join(filter(None, (panel.video and "the video", panel.masks and "the masks")))
    return f"{reach} {num_pictured} have pictures of all layers; the others show {beside}."


def archive_name(name: str) -> str:
    """Return a file name for the masks of a sequence, of characters that every system takes."""
    return f"{re.sub(r'[^A-Za-z0-9_.-]+', '_', name).strip('._-') or 'sequence'}_masks.zip"


def _choose_still(panel: SequencePanel, choice: Choice) -> int:
    """Return the place of the shown frame nearest to the middle that has a picture of the pane's base."""
    middle = len(panel.frames) // 2
    if choice.base is None:
        return middle
    pictures = panel.layers[choice.base].pictures
    known = [place for place, picture in enumerate(pictures) if picture is not None]
    return min(known, key=lambda place: abs(place - middle), default=middle)
