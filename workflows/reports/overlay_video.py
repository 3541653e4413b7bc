"""The overlay of a whole sequence, as a video small enough for a page."""

import math
from typing import NamedTuple

from moseg.schemas.configs import Variant
from moseg.workflows.exports.write_overlay import encode_overlay
from moseg.workflows.reports.missing import Missing, name_absent
from moseg.workflows.reports.picture_content import Video
from moseg.workflows.reports.sequence_view import PICTURE_SIDE, SequenceView

CONSTANT_RATE_FACTOR = 28
"""Of x264: at the size of a report its loss is hardly seen, and ten seconds take some hundred kilobytes."""
MOST_FRAMES = 900
"""Half a minute of a video at 30 frames per second; of longer ones every n-th frame is shown."""


class EncodedVideo(NamedTuple):
    """A video, or None, and what it does not show."""

    video: Video | None
    missing: tuple[Missing, ...] = ()


def encode_video(view: SequenceView, variant: Variant, fps: float) -> EncodedVideo:
    """The overlay of a variant at `fps` frames of the sequence per second, one frame in memory at a time."""
    leaves = view.graph.leaves
    step = math.ceil(len(leaves.frames) / MOST_FRAMES)
    frames = range(0, len(leaves.frames), step)
    refs = {*(leaves.frames[frame] for frame in frames), *view.label_refs(variant, frames)}
    absent = refs - view.store.present(refs)
    if absent:
        return EncodedVideo(None, (name_absent(f"video of {variant}", absent),))
    data = encode_overlay(
        (view.store.read(leaves.frames[frame], "image") for frame in frames),
        (view.labels(variant, frame) for frame in frames),
        fps / step,
        crf=CONSTANT_RATE_FACTOR,
        max_side=PICTURE_SIDE,
    )
    height, width = (side + side % 2 for side in view.shape)
    said = (f"The video shows one frame in {step} of {len(leaves.frames)}.",) if step > 1 else ()
    return EncodedVideo(Video(data, width, height, fps / step, step), said)
