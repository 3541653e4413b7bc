"""Boxes of named objects in one frame."""

from moseg.tasks.detections.detect import Detections, detect_objects
from moseg.tasks.detections.suppression import suppress_boxes

__all__ = ["Detections", "detect_objects", "suppress_boxes"]
