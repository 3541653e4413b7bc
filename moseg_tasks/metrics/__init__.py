"""Agreement of predicted with annotated moving objects: Pu/Ru/Fu, region and boundary similarity."""

from moseg_tasks.metrics.assign_objects import assign_objects
from moseg_tasks.metrics.boundary_similarity import BOUNDARY_TOLERANCE, boundary_map, boundary_similarity
from moseg_tasks.metrics.foreground_scores import ForegroundScores, score_foreground
from moseg_tasks.metrics.overlaps import Overlaps, add_overlaps, count_overlaps
from moseg_tasks.metrics.region_similarity import region_similarity
from moseg_tasks.metrics.score_sequence import FramePairs, score_sequence

__all__ = [
    "BOUNDARY_TOLERANCE",
    "ForegroundScores",
    "FramePairs",
    "Overlaps",
    "add_overlaps",
    "assign_objects",
    "boundary_map",
    "boundary_similarity",
    "count_overlaps",
    "region_similarity",
    "score_foreground",
    "score_sequence",
]
