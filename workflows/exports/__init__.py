"""Files that commands write: masks, an overlay video, a summary of the motions, contact sheets, exports."""

from moseg.workflows.exports.draw_overlay import draw_labels
from moseg.workflows.exports.motion_json import ObjectSummary, SequenceSummary, write_motion
from moseg.workflows.exports.overlay_style import OverlayMode, OverlayStyle
from moseg.workflows.exports.palette import davis_palette, identity_colours
from moseg.workflows.exports.summarise import summarise_sequence
from moseg.workflows.exports.write_masks import write_masks
from moseg.workflows.exports.write_overlay import encode_overlay, write_overlay
from moseg.workflows.exports.write_text import TextKind, check_folder, check_replaceable, write_text

__all__ = [
    "ObjectSummary",
    "OverlayMode",
    "OverlayStyle",
    "SequenceSummary",
    "TextKind",
    "check_folder",
    "check_replaceable",
    "davis_palette",
    "draw_labels",
    "encode_overlay",
    "identity_colours",
    "summarise_sequence",
    "write_masks",
    "write_motion",
    "write_overlay",
    "write_text",
]
