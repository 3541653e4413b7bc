"""Sources: small picklable values that say which files or scene to read, and read them."""

from workflows.sources.depth_files import DepthFiles
from workflows.sources.flow_files import FlowFiles
from workflows.sources.frames import FrameDescription, FrameSource, working_size
from workflows.sources.image_files import ImageFiles
from workflows.sources.labelled_points import LabelledPointFile
from workflows.sources.mask_files import MaskFiles, MaskKind, MaskSource
from workflows.sources.opening import open_depth, open_flow, open_frames, open_masks, open_tracks
from workflows.sources.scenes import SceneDepth, SceneFlow, SceneFrames, SceneMasks, SceneTracks
from workflows.sources.track_files import TrackFile
from workflows.sources.trajectory_files import TrajectoryFile, TrajectoryLabels
from workflows.sources.video_file import VideoFile

__all__ = [
    "DepthFiles",
    "FlowFiles",
    "FrameDescription",
    "FrameSource",
    "ImageFiles",
    "LabelledPointFile",
    "MaskFiles",
    "MaskKind",
    "MaskSource",
    "SceneDepth",
    "SceneFlow",
    "SceneFrames",
    "SceneMasks",
    "SceneTracks",
    "TrackFile",
    "TrajectoryFile",
    "TrajectoryLabels",
    "VideoFile",
    "open_depth",
    "open_flow",
    "open_frames",
    "open_masks",
    "open_tracks",
    "working_size",
]
