"""What the package `moseg` offers to Python: a video in, its moving objects out."""

from moseg.workflows.api.configuration import ConfigLike, load_config
from moseg.workflows.api.motion_segmentation import MotionSegmentation
from moseg.workflows.api.moving_object import MovingObject
from moseg.workflows.api.segment_video import segment_video
from moseg.workflows.api.video_source import VideoLike

__all__ = ["ConfigLike", "MotionSegmentation", "MovingObject", "VideoLike", "load_config", "segment_video"]
