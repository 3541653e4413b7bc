"""What the package `moseg` offers to Python: a video in, its moving objects out."""

from workflows.api.configuration import ConfigLike, load_config
from workflows.api.motion_segmentation import MotionSegmentation
from workflows.api.moving_object import MovingObject
from workflows.api.segment_video import segment_video
from workflows.api.video_source import VideoLike

__all__ = ["ConfigLike", "MotionSegmentation", "MovingObject", "VideoLike", "load_config", "segment_video"]
