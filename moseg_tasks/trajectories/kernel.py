"""The ordered residual kernel between trajectories, and its sparsification."""

import numpy as np

from moseg.schemas.parameters import KernelParams
from moseg.tasks.trajectories.hypothesis_residuals import HypothesisResiduals, preferences

_BLOCK_BYTES = 2**25
"""Of the preferences whose products are summed at once."""


def trajectory_kernels(residuals: HypothesisResiduals, num_draws: int, params: KernelParams) -> np.ndarray:
    """Return the share of preferred hypotheses that two trajectories have in common, over the sets that show both.

    In each set of frames a trajectory prefers the hypotheses nearest to it, a share `params.window` of all.

    Parameters
    ----------
    residuals : HypothesisResiduals
        Of N trajectories.
    num_draws : int
        The hypotheses of a draw are consecutive.
    params : KernelParams

    Returns
    -------
    kernels : float32 (num_draws, N, N)
        0..1, symmetric; 0 between trajectories never visible together, and for entries that `sparsify` removes.

    References
    ----------
    T.-J. Chin, H. Wang and D. Suter, "The ordered residual kernel for robust motion subspace clustering", NIPS 2009.
    """
    is_seen = residuals.is_seen
    num_hypotheses = residuals.num_hypotheses // num_draws
    count = min(max(1, round(params.window * num_hypotheses)), num_hypotheses)
    together = is_seen.T.astype(np.float32) @ is_seen.astype(np.float32)
    common = np.zeros((num_draws, *together.shape), np.float32)
    num_sets = max(1, _BLOCK_BYTES // (4 * len(together) * num_hypotheses))
    # Several sets side by side: one product is faster than a sum of one product per set.
    for start in range(0, len(is_seen), num_sets):
        block = range(start, min(start + num_sets, len(is_seen)))
        rows = np.flatnonzero(is_seen[block].any(axis=0))
        preferred = np.zeros((num_draws, len(rows), len(block), num_hypotheses), np.float32)
        for column, index in enumerate(block):
            seen, codes = residuals.of_set(index)
            nearest = preferences(codes.reshape(len(seen), num_draws, num_hypotheses), count)
            # Assignment to a slice takes half the time of that to an index.
            own = slice(None) if len(seen) == len(rows) else np.searchsorted(rows, seen)
            preferred[:, own, column] = np.moveaxis(nearest, 1, 0)
        for kernel, flat in zip(common, preferred.reshape(num_draws, len(rows), -1), strict=True):
            if len(rows) == len(kernel):
                kernel += flat @ flat.T
            else:
                kernel[np.ix_(rows, rows)] += flat @ flat.T
    # Equally near hypotheses are all preferred, so that two trajectories may share more than `count`.
    shares = np.minimum(common / (count * np.maximum(together, 1)), 1)
    return np.stack([sparsify(share, params.sparsity) for share in shares])


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
