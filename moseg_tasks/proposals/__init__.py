"""Object proposals without learned weights, and their identities across sections."""

from moseg.tasks.proposals.boxes import object_boxes
from moseg.tasks.proposals.components import Components, keep_best, keep_parts, label_components
from moseg.tasks.proposals.holes import fill_holes
from moseg.tasks.proposals.linking import count_overlaps, link_sections
from moseg.tasks.proposals.parting import part_distant
from moseg.tasks.proposals.refinement import refine_outlines
from moseg.tasks.proposals.rejoining import rejoin_components
from moseg.tasks.proposals.splitting import split_touching

__all__ = [
    "Components",
    "count_overlaps",
    "fill_holes",
    "keep_best",
    "keep_parts",
    "label_components",
    "link_sections",
    "object_boxes",
    "part_distant",
    "refine_outlines",
    "rejoin_components",
    "split_touching",
]
