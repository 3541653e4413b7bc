"""Files that `moseg segment` leaves behind: masks, an overlay video and a summary of the motions."""

from workflows.exports.draw_labels import draw_labels
from workflows.exports.motion_json import (
    MotionSummary,
    ObjectSummary,
    SequenceSummary,
    summarise_sequence,
    write_motion,
)
from workflows.exports.palette import davis_palette, identity_colours
from workflows.exports.write_masks import write_masks
from workflows.exports.write_overlay import write_overlay

__all__ = [
    "MotionSummary",
    "ObjectSummary",
    "SequenceSummary",
    "davis_palette",
    "draw_labels",
    "identity_colours",
    "summarise_sequence",
    "write_masks",
    "write_motion",
    "write_overlay",
]
