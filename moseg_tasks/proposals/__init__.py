"""Object proposals without any learned weights, and their identities across sections."""

from moseg_tasks.proposals.boxes import object_boxes
from moseg_tasks.proposals.components import Proposals, propose_objects
from moseg_tasks.proposals.linking import count_overlaps, link_sections

__all__ = ["Proposals", "count_overlaps", "link_sections", "object_boxes", "propose_objects"]
