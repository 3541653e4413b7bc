"""Dominant motion of a flow field: a RANSAC homography refined to a robust affine flow."""

from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np
import poselib

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.grid import pixel_grid

_MINIMAL_SAMPLE = 4
_SETTLED = 1e-3  # px/frame: change of the motion at the frame's border below which a fit ends
MAD_TO_SIGMA = 1.4826  # median of |x| of a unit Gaussian, inverted


class AffineMotion(NamedTuple):
    """Affine flow ``theta[0] + (xy - centre) @ theta[1:]``.

    Attributes
    ----------
    theta : float64 (3, 2)
        px/frame; rows 1, x, y.
    centre : float64 (2,)
        Mean position of the pixels it was fitted to, px.
    scale : float
        Robust standard deviation of its residuals, px/frame.
    """

    theta: np.ndarray
    centre: np.ndarray
    scale: float

    def to_json(self) -> dict:
        """Return the motion as lists and numbers, which `of_json` reads."""
        return {"theta": self.theta.tolist(), "centre": self.centre.tolist(), "scale": self.scale}

    @classmethod
    def of_json(cls, values: dict) -> "AffineMotion":
        """Return the motion of the values that `to_json` gave."""
        return cls(np.array(values["theta"]), np.array(values["centre"]), values["scale"])


def fit_background(flow: np.ndarray, params: SaliencyParams, among: np.ndarray | None = None) -> AffineMotion:
    """Fit the affine motion that most of the flow follows.

    The inliers of a homography fitted by RANSAC initialise a fit by Tukey's biweight. The homography alone would adapt
    to objects. Without `among` the band along the frame's border has more weight than the middle, because even a large
    object rarely covers the border.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame.
    params : SaliencyParams
    among : bool (y, x), optional
        Pixels to fit to; by default all, of which some in the middle are left out.

    Returns
    -------
    AffineMotion
    """
    thinning = params if among is None else None
    points, vectors = sample_flow(flow, params.ransac_step, among, thinning)
    samples = sample_flow(flow, params.affine_step, among, thinning)
    homography = _ransac_homography(points, points + vectors, params)
    start = None if homography is None else _homography_residual(homography, *samples)
    return _tukey_affine(*samples, start, params)


def affine_flow(motion: AffineMotion, shape: tuple[int, int]) -> np.ndarray:
    """Return the flow float32 (y, x, 2) of an affine motion on a grid of `shape`, px/frame."""
    linear = motion.theta[1:]
    matrix = np.column_stack([linear.T, motion.theta[0] - motion.centre @ linear])
    return cv2.transform(pixel_grid(shape), matrix.astype(np.float32))


def tukey_weight(residual: np.ndarray, cutoff: float) -> np.ndarray:
    """Return Tukey's biweight of residuals: 1 at 0, 0 from `cutoff` on."""
    return np.clip(1 - (residual / cutoff) ** 2, 0, None) ** 2


def is_settled(change: np.ndarray, reach: float) -> bool:
    """Return whether a change of `AffineMotion.theta` is negligible everywhere up to `reach` px from the centre."""
    largest = np.abs(change).max(axis=1)
    return bool(largest[0] + reach * (largest[1] + largest[2]) < _SETTLED)


def sample_flow(
    flow: np.ndarray, step: int, among: np.ndarray | None = None, thinning: SaliencyParams | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Sample positions and vectors float64 (N, 2) on a grid of `step` px, inside `among`, thinned out by `thinning`."""
    band, nth = (0.0, 1) if thinning is None else (thinning.border_band, thinning.centre_thinning)
    points, places = _grid_points(flow.shape[:2], step, band, nth)
    if among is not None:
        kept = among.reshape(-1)[places]
        points, places = points[kept], places[kept]
    return points, flow.reshape(-1, 2)[places].astype(np.float64)


@lru_cache(maxsize=32)
def _grid_points(shape: tuple[int, int], step: int, band: float, nth: int) -> tuple[np.ndarray, np.ndarray]:
    """Return xy float64 (N, 2) of the points of a grid, and their places int64 (N,) in a map of `shape`, read-only.

    Of those further than `band` heights from the border it is every `nth` one.
    """
    height, width = shape
    rows, columns = np.arange(step // 2 % height, height, step), np.arange(step // 2 % width, width, step)
    y, x = np.meshgrid(rows, columns, indexing="ij")
    middle = np.minimum(np.minimum(y, height - 1 - y), np.minimum(x, width - 1 - x)) >= band * height
    i, j = np.ogrid[: len(rows), : len(columns)]
    kept = ~middle | ((i + j) % nth == 0)
    y, x = y[kept], x[kept]
    points, places = np.column_stack([x, y]).astype(np.float64), y * width + x
    points.flags.writeable = places.flags.writeable = False
    return points, places


def _solve_spanned(normal: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve symmetric normal equations, with slope 0 in directions not spanned: of a single pixel, row or column."""
    values, vectors = np.linalg.eigh(normal)
    kept = values > 1e-10 * values[-1]
    return (vectors[:, kept] / values[kept]) @ (vectors[:, kept].T @ right)


def _ransac_homography(points0: np.ndarray, points1: np.ndarray, params: SaliencyParams) -> np.ndarray | None:
    """Fit the homography that maps most of `points0` to `points1`; None where there are too few of them."""
    if len(points0) <= _MINIMAL_SAMPLE:
        return None
    options = {
        "max_reproj_error": params.ransac_threshold,
        "min_iterations": params.ransac_iterations,
        "max_iterations": 10 * params.ransac_iterations,
        "seed": params.ransac_seed,
    }
    homography, report = poselib.estimate_homography(points0, points1, options, {})
    usable = report["num_inliers"] > _MINIMAL_SAMPLE and np.isfinite(homography).all()
    return homography if usable else None


def _homography_residual(homography: np.ndarray, points: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    mapped = points @ homography[:, :2].T + homography[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        error = mapped[:, :2] / mapped[:, 2:] - points - vectors
    return np.nan_to_num(np.hypot(error[:, 0], error[:, 1]), nan=np.inf)


def _tukey_affine(
    points: np.ndarray, vectors: np.ndarray, start: np.ndarray | None, params: SaliencyParams
) -> AffineMotion:
    """Fit by iteratively reweighted least squares under Tukey's biweight, from the residuals `start`."""
    centre = points.mean(axis=0) if len(points) else np.zeros(2)
    design = np.column_stack([np.ones(len(points)), points - centre])
    residual = np.zeros(len(points)) if start is None else start
    inliers = residual <= params.ransac_threshold
    theta, scale = np.zeros((3, 2)), params.affine_scale_floor
    reach = np.abs(design[:, 1:]).max(initial=0.0)
    for _ in range(params.affine_iterations):
        if not inliers.any():
            break
        scale = max(params.affine_scale_floor, MAD_TO_SIGMA * float(np.median(residual[inliers])))
        cutoff = params.tukey_constant * scale
        weight = tukey_weight(residual, cutoff)
        weighted = design * weight[:, None]
        previous, theta = theta, _solve_spanned(weighted.T @ design, weighted.T @ vectors)
        error = design @ theta - vectors
        residual = np.hypot(error[:, 0], error[:, 1])
        inliers = residual < cutoff
        if is_settled(theta - previous, reach):
            break
    return AffineMotion(theta, centre, scale)
