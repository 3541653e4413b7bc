"""Flow without gaps, for methods that need a vector at every pixel."""

import numpy as np
from scipy.ndimage import distance_transform_edt


def fill_unknown(flow: np.ndarray) -> np.ndarray:
    """Replace unknown vectors of a flow by that of the nearest known pixel.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame; not finite where it is unknown.

    Returns
    -------
    float32 (y, x, 2)
        `flow` itself where nothing is unknown; zeros where nothing is known.
    """
    finite = np.isfinite(flow)
    if finite.all():
        return flow
    unknown = ~finite.all(axis=-1)
    if unknown.all():
        return np.zeros_like(flow)
    rows, columns = distance_transform_edt(unknown, return_distances=False, return_indices=True)
    return flow[rows, columns]
