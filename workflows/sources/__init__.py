"""Sources: small picklable values that name files or a scene, and read them."""

from moseg.workflows.sources.depth_files import DepthFiles
from moseg.workflows.sources.flow_files import FlowFiles
from moseg.workflows.sources.frames import FrameDescription, FrameSource
from moseg.workflows.sources.image_files import ImageFiles
from moseg.workflows.sources.mask_files import MaskFiles, MaskKind, MaskSource
from moseg.workflows.sources.opening import open_depth, open_flow, open_frames, open_masks, open_tracks
from moseg.workflows.sources.resize import working_size
from moseg.workflows.sources.scenes import SceneDepth, SceneFlow, SceneFrames, SceneMasks, SceneTracks
from moseg.workflows.sources.track_files import TrackFile
from moseg.workflows.sources.trajectory_files import LabelledPointFile, LabelledPoints, TrajectoryFile, TrajectoryLabels
from moseg.workflows.sources.video_file import VideoFile

__all__ = [
    "DepthFiles",
    "FlowFiles",
    "FrameDescription",
    "FrameSource",
    "ImageFiles",
    "LabelledPointFile",
    "LabelledPoints",
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
