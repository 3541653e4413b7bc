"""Evidence of a frame pair: how many tracks a rigid scene explains that no single plane does."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import poselib

from moseg.schemas.parameters import SceneParallaxParams
from moseg.tasks.scene_parallax.rigid_camera import choose_focal, error_across, fit_camera, tolerance


class PairEvidence(NamedTuple):
    """Evidence of one frame pair.

    Attributes
    ----------
    motion : float
        Median displacement of the tracks, px.
    rigid_share, plane_share : float
        Shares of the tracks that a rigid scene, and a single homography, explain.
    heading : float64 (3,)
        Direction of the camera's translation, unit length, in its own axes.
    sees_epipole : bool
        Whether the epipole lies inside the frame.
    """

    motion: float
    rigid_share: float
    plane_share: float
    heading: np.ndarray
    sees_epipole: bool


def measure_pairs(
    pairs: Sequence[tuple[np.ndarray, np.ndarray]], shape: tuple[int, int], params: SceneParallaxParams
) -> tuple[float | None, list[PairEvidence]]:
    """Measure the frame pairs of a stretch over which the camera moves.

    Parameters
    ----------
    pairs : sequence of (float64 (N, 2), float64 (N, 2))
        Tracks of each pair, xy in its two frames, px.
    shape : (int, int)
        Height and width of the frames, px.
    params : SceneParallaxParams

    Returns
    -------
    focal : float or None
        Focal length of all pairs, in longer sides of the frame; None where the camera never moves.
    evidence : list of PairEvidence
        Only of pairs with enough tracks and motion.
    """
    moving = [pair for pair in pairs if len(pair[0]) >= params.min_tracks and _motion(*pair) >= params.min_motion]
    if not moving:
        return None, []
    spread = [_one_per_cell(*pair, params.cell) for pair in moving]
    # Every other pair determines it as well, at half the time.
    focal = choose_focal(spread[::2], shape, params)
    measured = (_measure(*pair, *sample, focal, shape, params) for pair, sample in zip(moving, spread, strict=True))
    return focal, [evidence for evidence in measured if evidence is not None]


def _measure(points0, points1, sample0, sample1, focal, shape, params) -> PairEvidence | None:
    """Return the evidence of all tracks under models of a sample spread over the frame; None without a rigid one."""
    camera = fit_camera(sample0, sample1, focal, shape, params)
    if camera is None:
        return None
    allowed = tolerance(points0, points1, params)
    plane_error = _homography_error(points0, points1, sample0, sample1, params)
    return PairEvidence(
        motion=_motion(points0, points1),
        rigid_share=float((error_across(points0, points1, camera) < allowed).mean()),
        plane_share=float((plane_error < params.plane_slack * allowed).mean()),
        heading=camera.translation,
        sees_epipole=camera.sees_epipole(shape),
    )


def _homography_error(points0, points1, sample0, sample1, params) -> np.ndarray:
    """Return the transfer error of all points under the homography of a sample: float64 (N,), px."""
    options = {
        "max_reproj_error": params.threshold,
        "min_iterations": params.num_samples,
        "max_iterations": 2 * params.num_samples,
        "seed": 0,
    }
    H, _ = poselib.estimate_homography(sample0, sample1, options, {})
    moved = np.concatenate([points0, np.ones((len(points0), 1))], axis=1) @ np.asarray(H).T
    # A point at infinity is explained by no homography.
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(np.linalg.norm(moved[:, :2] / moved[:, 2:] - points1, axis=1), nan=np.inf)


def _one_per_cell(points0: np.ndarray, points1: np.ndarray, cell: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the first track of each cell of the first frame, so that no textured part outweighs the others."""
    column, row = (points0 // cell).astype(np.intp).T
    _, first = np.unique(row * (column.max() + 1) + column, return_index=True)
    return points0[first], points1[first]


def _motion(points0: np.ndarray, points1: np.ndarray) -> float:
    """Return the median displacement, px."""
    return float(np.median(np.linalg.norm(points1 - points0, axis=1)))
