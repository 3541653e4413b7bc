"""Shifts of a pattern over the frames of a video, to a small fraction of a pixel."""

import numpy as np

_ROUNDS = 3
_OUTLIER = 2.0  # median residuals at which a pixel counts half
_LEAST_RESIDUAL = 1.0  # grey level
_LEAST_CROSSING = 0.05
"""Gradients across the main direction, of all: a pattern of fewer is a line, along which no shift can be seen."""


def shifts(levels: np.ndarray, gradient: np.ndarray) -> np.ndarray | None:
    """Estimate the shift of a pattern in each frame from where it is in the median frame.

    Brightness and contrast may change from frame to frame: at 0.8 of the contrast a shift is found to be 0.8 of what
    it is. Pixels that show something else are given less weight.

    Parameters
    ----------
    levels : uint8 (frame, pixel)
        Grey levels of the pixels of the pattern.
    gradient : float32 (pixel, 2)
        Their gradients in the median frame, xy, grey levels per px.

    Returns
    -------
    float64 (frame,) or None
        Lengths, px, from the median shift; None where the pattern is a line.

    References
    ----------
    Lucas, Kanade, "An iterative image registration technique", IJCAI 1981, with Cauchy's weights.
    """
    tensor = np.linalg.eigvalsh(gradient.T @ gradient)
    if tensor[0] < _LEAST_CROSSING * tensor.sum():
        return None
    usual = np.median(levels, axis=0)
    model = np.column_stack([usual, np.ones(len(usual)), -gradient]).astype(np.float64)
    found = np.array([_shift(model, frame.astype(np.float64)) for frame in levels])
    return np.linalg.norm(found - np.median(found, axis=0), axis=1)


def _shift(model: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Return the shift xy of a frame by iteratively reweighted least squares."""
    weights = np.ones(len(levels))
    for _ in range(_ROUNDS):
        root = np.sqrt(weights)
        solution = np.linalg.lstsq(model * root[:, None], levels * root, rcond=None)[0]
        residual = np.abs(levels - model @ solution)
        scale = _OUTLIER * max(_LEAST_RESIDUAL, float(np.median(residual)))
        weights = 1 / (1 + (residual / scale) ** 2)
    return solution[2:]
