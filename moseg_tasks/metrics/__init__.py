"""Agreement of predicted with annotated moving objects: Pu/Ru/Fu, region and boundary similarity."""

from moseg.tasks.metrics.assign_objects import assign_objects
from moseg.tasks.metrics.boundary_similarity import BOUNDARY_TOLERANCE, boundary_map, boundary_similarity
from moseg.tasks.metrics.clustering_error import clustering_error
from moseg.tasks.metrics.foreground_scores import ForegroundScores, score_foreground
from moseg.tasks.metrics.overlaps import Overlaps, add_overlaps, count_overlaps, region_similarity
from moseg.tasks.metrics.point_scores import PointPairs, count_point_overlaps, sample_points, score_points
from moseg.tasks.metrics.score_sequence import FramePairs, score_sequence
from moseg.tasks.metrics.still_scores import score_still

__all__ = [
    "BOUNDARY_TOLERANCE",
    "ForegroundScores",
    "FramePairs",
    "Overlaps",
    "PointPairs",
    "add_overlaps",
    "assign_objects",
    "boundary_map",
    "boundary_similarity",
    "clustering_error",
    "count_overlaps",
    "count_point_overlaps",
    "region_similarity",
    "sample_points",
    "score_foreground",
    "score_points",
    "score_sequence",
    "score_still",
]
