"""Functions and classes that the package `moseg` offers to Python."""

from moseg.workflows.api.configuration import load_config
from moseg.workflows.api.evaluate import ablate, evaluate
from moseg.workflows.api.motion_segmentation import MotionSegmentation
from moseg.workflows.api.moving_object import MovingObject
from moseg.workflows.api.score import score
from moseg.workflows.api.segment_video import segment_video
from moseg.workflows.api.video_source import VideoLike
from moseg.workflows.config.pipeline_choices import ConfigLike

__all__ = [
    "ConfigLike",
    "MotionSegmentation",
    "MovingObject",
    "VideoLike",
    "ablate",
    "evaluate",
    "load_config",
    "score",
    "segment_video",
]
