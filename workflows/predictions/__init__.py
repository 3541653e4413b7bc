"""Readers of masks that any method saved, for scoring."""

from moseg.workflows.predictions.formats import FORMATS, PredictionFormat, SequencePredictions, detect_format
from moseg.workflows.predictions.frame_list import FrameList
from moseg.workflows.predictions.label_images import read_label_image
from moseg.workflows.predictions.open_predictions import Predictions, open_predictions

__all__ = [
    "FORMATS",
    "FrameList",
    "PredictionFormat",
    "Predictions",
    "SequencePredictions",
    "detect_format",
    "open_predictions",
    "read_label_image",
]
