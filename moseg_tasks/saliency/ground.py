"""The ground: the plane that carries the lower part of the frame."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.background import tukey_weight

_MINIMAL_SAMPLE = 3


class Ground(NamedTuple):
    """A plane's inverse depth ``plane[0] + plane[1] x + plane[2] y``, linear in the pixel's position.

    Attributes
    ----------
    plane : float64 (3,)
        x and y in px of the grid.
    share : float
        Share of the frame's lower part that lies on it, 0..1.
    approach : float
        Growth of its parallax over the lower part, px/frame: positive for a ground, 0 for a wall that faces the camera.
    """

    plane: np.ndarray
    share: float
    approach: float

    @property
    def tilt(self) -> float:
        """Slope across the frame over slope down the frame; 0 for a level camera, infinite for a wall at the side."""
        return float(abs(self.plane[1]) / abs(self.plane[2])) if self.plane[2] else float("inf")

    def inverse_depth(self, shape: tuple[int, int]) -> np.ndarray:
        """Return the plane's inverse depth, float32 (y, x), on a grid of `shape`."""
        height, width = shape
        x, y = np.arange(width)[None, :], np.arange(height)[:, None]
        return (self.plane[0] + self.plane[1] * x + self.plane[2] * y).astype(np.float32)


def fit_ground(inverse_depth: np.ndarray, reach: np.ndarray, params: SaliencyParams) -> Ground:
    """Fit the plane of most of the frame's lower part, by RANSAC and Tukey's biweight on its parallax.

    Parameters
    ----------
    inverse_depth : float32 (y, x)
        Relative.
    reach : float32 (y, x)
        Parallax at unit inverse depth, px/frame: turns errors of inverse depth into px/frame.
    params : SaliencyParams

    Returns
    -------
    Ground
    """
    height, width = inverse_depth.shape
    step = params.ground_step
    top = int(height * params.ground_top)
    rows, columns = np.arange(top + step // 2 % (height - top), height, step), np.arange(step // 2 % width, width, step)
    y, x = (axis.ravel() for axis in np.meshgrid(rows, columns, indexing="ij"))
    values, weights = inverse_depth[y, x].astype(np.float64), reach[y, x].astype(np.float64)
    design = np.column_stack([np.ones(len(x)), x, y])
    plane = _ransac_plane(design, values, weights, params)
    # Points that deviate by the tolerance still belong to an uneven ground.
    cutoff = 2 * params.ground_tolerance
    for _ in range(params.ground_iterations):
        error = (design @ plane - values) * weights
        weight = tukey_weight(error, cutoff) * weights**2
        weighted = design * weight[:, None]
        plane = np.linalg.pinv(weighted.T @ design, rcond=1e-12, hermitian=True) @ (weighted.T @ values)
    error = np.abs(design @ plane - values) * weights
    approach = plane[2] * (height - top) * np.median(weights)
    return Ground(plane, float(np.mean(error < params.ground_tolerance)), float(approach))


def _ransac_plane(design: np.ndarray, values: np.ndarray, weights: np.ndarray, params: SaliencyParams) -> np.ndarray:
    """Return the plane through a random triple of points that has the most points within the tolerance."""
    if len(values) < _MINIMAL_SAMPLE:
        return np.zeros(3)
    rng = np.random.default_rng(params.ransac_seed)
    triples = rng.integers(len(values), size=(params.ground_samples, _MINIMAL_SAMPLE))
    # Triples on a line have no plane; their pseudo-inverse gives a plane without support.
    planes = np.linalg.pinv(design[triples], rcond=1e-9) @ values[triples][..., None]
    error = np.abs(design @ planes[..., 0].T - values[:, None]) * weights[:, None]
    return planes[np.argmax(np.count_nonzero(error < params.ground_tolerance, axis=0)), :, 0]
