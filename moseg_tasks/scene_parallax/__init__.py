"""Parallax of a stretch of video: does the camera drive through a scene with depth?"""

from moseg.tasks.scene_parallax.corner_pairs import follow_corners
from moseg.tasks.scene_parallax.pair_evidence import PairEvidence, count_still, measure_pairs
from moseg.tasks.scene_parallax.source_choice import SALIENCY, TRACKS, SourceChoice, choose_source

__all__ = [
    "SALIENCY",
    "TRACKS",
    "PairEvidence",
    "SourceChoice",
    "choose_source",
    "count_still",
    "follow_corners",
    "measure_pairs",
]
