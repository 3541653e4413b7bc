"""Sources: small picklable values that name files or a scene, and read them.

Each is imported when it is first used: a listing of files needs no decoder.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from moseg.workflows.sources.depth_files import DepthFiles
    from moseg.workflows.sources.flow_files import FlowFiles
    from moseg.workflows.sources.frames import FrameDescription, FrameSource
    from moseg.workflows.sources.image_files import ImageFiles
    from moseg.workflows.sources.mask_files import MaskFiles, MaskKind, MaskSource, find_mask_kind
    from moseg.workflows.sources.motion_weights import MotionWeights
    from moseg.workflows.sources.opening import open_depth, open_flow, open_frames, open_masks, open_tracks
    from moseg.workflows.sources.resize import working_size
    from moseg.workflows.sources.scenes import SceneDepth, SceneFlow, SceneFrames, SceneMasks, SceneTracks, find_scene
    from moseg.workflows.sources.track_files import TrackFile
    from moseg.workflows.sources.trajectory_files import (
        LabelledPointFile,
        LabelledPoints,
        TrajectoryFile,
        TrajectoryLabels,
    )
    from moseg.workflows.sources.video_file import VideoFile
    from moseg.workflows.sources.warped_picture import WarpedPicture

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
    "MotionWeights",
    "SceneDepth",
    "SceneFlow",
    "SceneFrames",
    "SceneMasks",
    "SceneTracks",
    "TrackFile",
    "TrajectoryFile",
    "TrajectoryLabels",
    "VideoFile",
    "WarpedPicture",
    "find_mask_kind",
    "find_scene",
    "open_depth",
    "open_flow",
    "open_frames",
    "open_masks",
    "open_tracks",
    "working_size",
]

_HOMES = {
    "DepthFiles": "depth_files",
    "FlowFiles": "flow_files",
    "FrameDescription": "frames",
    "FrameSource": "frames",
    "ImageFiles": "image_files",
    "LabelledPointFile": "trajectory_files",
    "LabelledPoints": "trajectory_files",
    "MaskFiles": "mask_files",
    "MaskKind": "mask_files",
    "MaskSource": "mask_files",
    "MotionWeights": "motion_weights",
    "SceneDepth": "scenes",
    "SceneFlow": "scenes",
    "SceneFrames": "scenes",
    "SceneMasks": "scenes",
    "SceneTracks": "scenes",
    "TrackFile": "track_files",
    "TrajectoryFile": "trajectory_files",
    "TrajectoryLabels": "trajectory_files",
    "VideoFile": "video_file",
    "WarpedPicture": "warped_picture",
    "find_mask_kind": "mask_files",
    "find_scene": "scenes",
    "open_depth": "opening",
    "open_flow": "opening",
    "open_frames": "opening",
    "open_masks": "opening",
    "open_tracks": "opening",
    "working_size": "resize",
}


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
