"""Cameras and depth of the frame pairs of a window of frames."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import CameraParams, DepthAnything3Params
from moseg.tasks.cameras.rays import cameras_of_rays
from moseg.tasks.cameras.scene_cameras import SceneCameras, decode_cameras
from moseg.tasks.depth.depth_anything_3 import images_to_pixels
from moseg.tasks.depth.dpt_dinov2 import resize_maps
from moseg.tasks.networks.depth_anything_3 import DepthAnything3Views


class PairCameras(NamedTuple):
    """Motion of the camera over P frame pairs of F frames, and the depth of each frame.

    Attributes
    ----------
    pairs : int32 (P, 2)
        First frame, and frames to the second.
    pose : float64 (P, 3, 4)
        [R | t] from the axes of the first frame's camera (x right, y down, z ahead) to those of the second's.
    intrinsics : float64 (F, 3, 3)
        Calibration matrix of each frame's camera, px.
    inverse_depth : float32 (F, y, x)
        1 / z in each frame, in the inverse of the unit of t in the pairs that begin with it.
    """

    pairs: np.ndarray
    pose: np.ndarray
    intrinsics: np.ndarray
    inverse_depth: np.ndarray


def estimate_cameras(
    network: DepthAnything3Views,
    images: np.ndarray,
    gaps: Sequence[int],
    params: CameraParams,
    depth_params: DepthAnything3Params,
) -> PairCameras:
    """Estimate the camera's motion over all frame pairs of some gaps, and the depth of the frames.

    The network sees runs of frames at once. Runs overlap, so that both frames of a pair are in the run of its first
    frame, and the motion of a pair has the unit of the depth of its first frame.

    Parameters
    ----------
    network : DepthAnything3Views
    images : uint8 (F, y, x, 3)
        RGB frames of a window.
    gaps : sequence of int
        Numbers of frames between the frames of a pair.
    params : CameraParams
    depth_params : DepthAnything3Params

    Raises
    ------
    InputError
        The network's output is not finite.
    """
    num_frames, shape = len(images), images.shape[1:3]
    pixels = images_to_pixels(images, depth_params.side)
    pairs, poses = [], []
    focal = np.empty((num_frames, 2))
    inverse_depth = np.empty((num_frames, *shape), np.float32)
    for owned, first, last in _runs(num_frames, max(gaps), params.views):
        with torch.inference_mode():
            views = network(pixels[first:last].to(network.device))
            mine = slice(owned.start - first, owned.stop - first)
            inverse_depth[owned.start : owned.stop] = resize_maps((-views.depth[mine]).exp(), shape).cpu().numpy()
        cameras = _decode(views)
        focal[owned.start : owned.stop] = cameras.focal[mine]
        for start in owned:
            for gap in gaps:
                if start + gap < num_frames:
                    pairs.append((start, gap))
                    poses.append(cameras.motion(start - first, start + gap - first))
    if not (np.isfinite(inverse_depth).all() and np.isfinite(poses).all() and np.isfinite(focal).all()):
        raise InputError("depth or cameras are not finite", where=f"the output of {type(network).__name__}")
    return PairCameras(
        np.array(pairs, np.int32).reshape(-1, 2),
        np.array(poses).reshape(-1, 3, 4),
        _calibrations(focal, shape),
        inverse_depth,
    )


def _runs(num_frames: int, reach: int, views: int) -> list[tuple[range, int, int]]:
    """Return the first frames of pairs of each run, and the frames first..last that the network sees at once."""
    length = max(views, reach + 1)
    step = length - reach
    num_runs = max(-(-(num_frames - reach) // step), 1)
    runs = []
    for index in range(num_runs):
        start, stop = index * step, (index + 1) * step if index + 1 < num_runs else num_frames
        last = min(start + length, num_frames)
        # The last run is as long as the others, where there are as many frames.
        runs.append((range(start, stop), max(min(start, last - length), 0), last))
    return runs


def _decode(views) -> SceneCameras:
    if views.cameras is not None:
        return decode_cameras(views.cameras.cpu().numpy())
    return cameras_of_rays(views.rays.cpu().numpy())


def _calibrations(focal: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return calibration matrices (F, 3, 3) of focal lengths (F, 2) in widths and heights, px."""
    height, width = shape
    found = np.zeros((len(focal), 3, 3))
    found[:, 0, 0], found[:, 1, 1] = focal.T * np.array([[width], [height]])
    found[:, 0, 2], found[:, 1, 2], found[:, 2, 2] = (width - 1) / 2, (height - 1) / 2, 1
    return found
