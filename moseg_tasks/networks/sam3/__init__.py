"""SAM 3: objects that a phrase names, outlined in an image, and masks tracked through a video."""

from moseg.tasks.networks.sam3.detector import Sam3Detector, build_sam3_detector
from moseg.tasks.networks.sam3.tracker import Sam3Tracker, build_sam3_tracker

__all__ = ["Sam3Detector", "Sam3Tracker", "build_sam3_detector", "build_sam3_tracker"]
