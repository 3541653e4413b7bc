"""Confidence: how sure it is that an object moves, and how much of it its mask covers."""

from moseg.tasks.confidence.estimate import Confidence, estimate_confidence
from moseg.tasks.confidence.kept_area import kept_area
from moseg.tasks.confidence.mask_evidence import MaskEvidence, mask_evidence

__all__ = ["Confidence", "MaskEvidence", "estimate_confidence", "kept_area", "mask_evidence"]
