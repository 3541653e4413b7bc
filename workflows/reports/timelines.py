"""Timelines of the objects of a sequence: area in each frame, changes of the mask, and pictures cut out of frames."""

import math
from collections.abc import Mapping, Sequence

import cv2
import numpy as np

from moseg.schemas.configs import Variant
from moseg.workflows.exports.motion_json import ObjectSummary
from moseg.workflows.reports.content import ObjectTimeline, Thumbnail
from moseg.workflows.reports.layers import SequenceView, all_colours, as_hex, encode_opaque
from moseg.workflows.results.mask_history import MaskHistory

MAX_TIMELINES = 12
"""Objects with a timeline, the largest first: the rows of more would not be read."""
NUM_THUMBNAILS = 8
"""Of each object; on a phone more would be smaller than a finger."""
MAX_AREAS = 900
"""Points of a timeline."""
THUMBNAIL_SHAPE = (72, 96)
"""Height and width, px."""
MARGIN = 0.15
"""Around an object's box, of its longer side."""
DIMMED = 0.45
"""Brightness of pixels outside the object."""


def make_timelines(
    view: SequenceView, variant: Variant, history: MaskHistory, objects: Sequence[ObjectSummary]
) -> tuple[ObjectTimeline, ...]:
    """Return the timelines of the largest objects; without thumbnails where frames are not in the store.

    Raises
    ------
    CorruptArtifactError
        A frame's bytes are not those committed.
    """
    shown = history.identities()[:MAX_TIMELINES]
    summaries = {each.identity: each for each in objects}
    areas = {identity: history.areas(identity) for identity in shown}
    thumbnails = _cut_thumbnails(view, variant, areas)
    step = math.ceil(history.num_frames / MAX_AREAS)
    num_pixels = math.prod(view.graph.leaves.shape)
    colours = all_colours()
    return tuple(
        ObjectTimeline(
            name=" ".join(filter(None, (str(identity), summaries[identity].tag))),
            colour=as_hex(colours[identity]),
            areas=tuple((100 * areas[identity][::step] / num_pixels).round(3).tolist()),
            step=step,
            changes=history.changes(identity),
            thumbnails=thumbnails.get(identity, ()),
            moving_frames=summaries[identity].moving_frames,
        )
        for identity in shown
    )


def choose_thumbnails(areas: np.ndarray, num_thumbnails: int = NUM_THUMBNAILS) -> tuple[int | None, ...]:
    """Return the frame nearest to the middle of each of equal stretches in which an area is not 0, None without one.

    Parameters
    ----------
    areas : int64 (frame,)
    """
    num_stretches = min(num_thumbnails, len(areas))
    chosen = []
    for stretch in range(num_stretches):
        first, end = (len(areas) * place // num_stretches for place in (stretch, stretch + 1))
        seen = first + np.flatnonzero(areas[first:end])
        middle = (first + end - 1) / 2
        chosen.append(int(min(seen, key=lambda frame: abs(frame - middle))) if len(seen) else None)
    return tuple(chosen)


def cut_out(image: np.ndarray, mask: np.ndarray, shape: tuple[int, int] = THUMBNAIL_SHAPE) -> np.ndarray:
    """Cut an object out of a frame, uint8 (y, x, rgb) of `shape`; pixels outside its mask are darker.

    Parameters
    ----------
    image : uint8 (y, x, rgb)
    mask : bool (y, x)
        With at least one pixel.
    shape : (int, int)
        Height and width of the result, px.
    """
    x, y, width, height = cv2.boundingRect(mask.view(np.uint8))
    # The box grows to the result's proportions about its centre; the picture's border is repeated beyond it.
    side = (1 + 2 * MARGIN) * max(width / shape[1], height / shape[0])
    wanted = side * shape[1], side * shape[0]
    shaded = np.where(mask[..., None], image, (image * DIMMED).astype(np.uint8))
    left, top = x + width / 2 - wanted[0] / 2, y + height / 2 - wanted[1] / 2
    scale = 1 / side
    affine = np.array([[scale, 0, -left * scale], [0, scale, -top * scale]])
    if scale < 1:
        # Averaging first: sampling every few pixels would leave a coarse picture.
        blur = max(1, round(side))
        shaded = cv2.blur(shaded, (blur, blur))
    size = (shape[1], shape[0])
    return cv2.warpAffine(shaded, affine, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


def _cut_thumbnails(
    view: SequenceView, variant: Variant, areas: Mapping[int, np.ndarray]
) -> dict[int, tuple[Thumbnail | None, ...]]:
    """Cut the objects out of the frames chosen for each, one frame in memory at a time."""
    chosen = {identity: choose_thumbnails(each) for identity, each in areas.items()}
    frames = sorted({frame for each in chosen.values() for frame in each if frame is not None})
    refs = {view.graph.leaves.frames[frame] for frame in frames}
    if refs - view.store.present(refs):
        return {}
    made = {}
    for frame in frames:
        image, labels = view.store.read(view.graph.leaves.frames[frame], "image"), view.labels(variant, frame)
        for identity, each in chosen.items():
            if frame in each:
                made[identity, frame] = Thumbnail(frame, encode_opaque(cut_out(image, labels == identity)))
    return {identity: tuple(made.get((identity, frame)) for frame in each) for identity, each in chosen.items()}
