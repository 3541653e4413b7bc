"""The ordered residual kernel between trajectories, and its sparsification."""

import numpy as np

from moseg.schemas.parameters import KernelParams


def trajectory_kernel(residuals: np.ndarray, params: KernelParams) -> np.ndarray:
    """Return the share of preferred hypotheses that two trajectories have in common, over the sets that show both.

    In each set of frames a trajectory prefers the hypotheses nearest to it, a share `params.window` of all.

    Parameters
    ----------
    residuals : floating (S, H, N)
        px; NaN if a trajectory is not visible.
    params : KernelParams

    Returns
    -------
    kernel : float32 (N, N)
        0..1, symmetric; 0 between trajectories never visible together, and for entries that `sparsify` removes.

    References
    ----------
    T.-J. Chin, H. Wang and D. Suter, "The ordered residual kernel for robust motion subspace clustering", NIPS 2009.
    """
    num_sets, num_hypotheses, num_tracks = residuals.shape
    count = min(max(1, round(params.window * num_hypotheses)), num_hypotheses)
    is_seen = ~np.isnan(residuals[:, 0])
    together = is_seen.T.astype(np.float32) @ is_seen.astype(np.float32)
    # All sets side by side: one product is faster than a sum of one product per set.
    preferred = np.zeros((num_tracks, num_sets * num_hypotheses), np.float32)
    for index, (distances, seen) in enumerate(zip(residuals, map(np.flatnonzero, is_seen), strict=True)):
        nearest = _nearest(distances[:, seen].T.astype(np.float32), count)
        preferred[seen[:, None], index * num_hypotheses + nearest] = 1.0
    common = preferred @ preferred.T / count
    return sparsify(common / np.maximum(together, 1), params.sparsity)


def sparsify(kernel: np.ndarray, power: float) -> np.ndarray:
    """Keep the entries of a kernel whose information is above the average of their row or column.

    The differences of a row's powers from the largest are normalised to probabilities: an entry is kept if its
    information ``-log p`` exceeds the row's entropy. Entries kept only by the row or only by the column are halved.

    Parameters
    ----------
    kernel : float32 (N, N)
        Non-negative.
    power : float
        0 keeps all entries.

    References
    ----------
    T. Lai et al., "Motion segmentation via a sparsity constraint", IEEE T-ITS 2017.
    """
    if power == 0:
        return kernel
    powers = kernel.astype(np.float64) ** power
    gaps = powers.max(axis=1, keepdims=True) - powers
    total = gaps.sum(axis=1, keepdims=True)
    share = gaps / np.where(total > 0, total, 1.0)
    log_share = np.log(np.maximum(share, np.finfo(np.float64).tiny))
    entropy = -(share * log_share).sum(axis=1, keepdims=True)
    kept = -log_share > entropy
    return (kernel * ((kept.astype(np.float32) + kept.T) / 2)).astype(np.float32)


def _nearest(distances: np.ndarray, count: int) -> np.ndarray:
    """Return indices (N, count) of the nearest hypotheses of each trajectory, from distances (N, H)."""
    return np.argpartition(distances, min(count, distances.shape[1] - 1), axis=1)[:, :count]
