"""Objects of a frame: from masks of detections to the seeds of tracking."""

from moseg.tasks.instances.paint import Painted, paint_instances
from moseg.tasks.instances.seeds import Seeds, merge_seeds
from moseg.tasks.instances.select import select_instances

__all__ = ["Painted", "Seeds", "merge_seeds", "paint_instances", "select_instances"]
