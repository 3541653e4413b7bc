"""The object under a point."""

import numpy as np

OUTSIDE = -1


def labels_at(mask: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the label of the pixel nearest to each point.

    Parameters
    ----------
    mask : uint16 (y, x)
    points : float (N, 2)
        xy, px.

    Returns
    -------
    labels : int64 (N,)
        -1 for points outside the frame.
    """
    height, width = mask.shape
    # Halves are rounded up: with rounding to even the nearest pixel would depend on the parity of the position.
    x, y = np.floor(points + 0.5).astype(np.int64).T
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    labels = np.full(len(points), OUTSIDE, dtype=np.int64)
    labels[inside] = mask[y[inside], x[inside]]
    return labels
