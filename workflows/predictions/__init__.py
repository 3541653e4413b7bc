"""Readers of masks that any method saved, for scoring."""

from moseg.workflows.predictions.formats import FORMATS, Predictions, SequencePredictions, open_predictions
from moseg.workflows.predictions.frame_files import FrameList

__all__ = ["FORMATS", "FrameList", "Predictions", "SequencePredictions", "open_predictions"]
