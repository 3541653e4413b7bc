"""Focal length of a window of frames near a given one: that with which given cameras explain the tracks best."""

from collections.abc import Callable, Mapping

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.focal_length import best_focal
from moseg.tasks.rigidity.given_camera import correct_camera

_UNEXPLAINED = 1.0


def correct_focal(
    given: float,
    poses: Mapping[tuple[int, int], np.ndarray],
    depth_of: Callable[[int], np.ndarray],
    points: np.ndarray,
    visible: np.ndarray,
    params: RigidityParams,
) -> float | None:
    """Return the focal length near the given one with which given cameras, corrected by tracks, explain these best.

    As `choose_focal`, but positions are compared, not only epipolar lines, and the given one is preferred.

    Parameters
    ----------
    given : float
        In longer sides of the frame.
    poses : dict of (int, int) to float64 (3, 4)
        Given motions by first frame and frames to the second.
    depth_of : function
        From a frame's index to its inverse depth float32 (y, x), in the inverse of their unit.
    points : float32 (N, F, 2)
        xy of the tracks, px.
    visible : bool (N, F)
    params : RigidityParams

    Returns
    -------
    float or None
        None if the cameras explain too few tracks with any of them.
    """
    focals, costs = given * np.array(params.camera_focals), []
    for start, gap in _spread_pairs(poses, params):
        seen = visible[:, start] & visible[:, start + gap]
        both = (points[seen, frame].astype(np.float64) for frame in (start, start + gap))
        found = [depth_of(start), *both]
        cameras = [correct_camera(poses[start, gap], *found, focal, params) for focal in focals]
        costs.append([_UNEXPLAINED if camera is None else camera.cost for camera in cameras])
    cost = np.mean(costs, axis=0) if costs else np.full(len(focals), _UNEXPLAINED)
    return best_focal(focals, cost, given, params.focal_slack) if cost.min() < _UNEXPLAINED else None


def _spread_pairs(poses: Mapping[tuple[int, int], np.ndarray], params: RigidityParams) -> list[tuple[int, int]]:
    """Return some pairs of the largest gap, spread over the window."""
    reach = max((gap for _, gap in poses), default=0)
    pairs = sorted(pair for pair in poses if pair[1] == reach)
    places = np.linspace(0, len(pairs) - 1, min(params.focal_pairs, len(pairs))).round().astype(int)
    return [pairs[place] for place in places]
