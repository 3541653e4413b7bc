"""Directions that all motions of a clip span together: noise is removed across them, and strays are far from them."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import NoiseReductionParams

_FAR = 2.0
"""Ratio of a residual to the usual one above which a trajectory does not take part in the estimate of the subspace."""
_VERY_FAR = 10.0
"""The same ratio for a stray."""
_SAMPLES = 512
"""Of the density of singular values of noise."""


class CleanTrajectories(NamedTuple):
    """Points float64 (N, frame, xy) with less noise, px, and which trajectories follow no motion: bool (N,)."""

    points: np.ndarray
    is_stray: np.ndarray


class _Subspace(NamedTuple):
    """Gaussian model of the coordinates of trajectories in a window, D = 2 * number of its frames."""

    mean: np.ndarray
    """float64 (D,)"""
    basis: np.ndarray
    """float64 (D, r): orthonormal."""
    variances: np.ndarray
    """float64 (r,): of the coordinates along the basis, px²."""
    noise: float
    """Standard deviation of a coordinate, px."""
    usual: float
    """Lower quartile of the root mean square distances of trajectories to the subspace, px."""


def reduce_noise(points: np.ndarray, visible: np.ndarray, params: NoiseReductionParams) -> CleanTrajectories:
    """Return the points with less noise, or as they are where noise is small, and the strays.

    The trajectories of a rigid motion span about four dimensions, and those of a few motions about a dozen, while noise
    has as many as there are coordinates. In windows of frames, trajectories seen throughout show the noise, by the
    smallest singular values of their coordinates, and the directions that exceed it; every trajectory becomes what is
    most probable for its visible points. The same linear map for all trajectories keeps the subspace of each
    rigid motion, so that groups are not mixed. Trajectories far from the directions of all others do not take part in
    the estimates and stay as they are. Those very far in all windows that they span, such as tracks that slipped, are
    strays. Time and memory are linear in the number of points.

    Parameters
    ----------
    points : float64 (N, frame, xy)
        px.
    visible : bool (N, frame)
    params : NoiseReductionParams

    Returns
    -------
    CleanTrajectories
        The points that are not visible are unchanged.

    References
    ----------
    V. Marchenko and L. Pastur, "Distribution of eigenvalues for some sets of random matrices", 1967; M. Gavish and
    D. Donoho, "The optimal hard threshold for singular values is 4 / sqrt(3)", IEEE T-IT 2014 (noise from the singular
    values); M. Tipping and C. Bishop, "Probabilistic principal component analysis", 1999 (hidden coordinates).
    """
    total, weights = np.zeros(points.shape), np.zeros(visible.shape)
    num_windows, num_far = np.zeros((2, len(points)), int)
    for frames in _windows(visible, params):
        seen = visible[:, frames]
        spanning = np.flatnonzero(seen.all(axis=1))
        subspace = _subspace_of(points[spanning, frames].reshape(len(spanning), 2 * seen.shape[1]), params)
        if subspace is None:
            continue
        counts = seen.sum(axis=1)
        own = np.flatnonzero(counts >= params.min_visible)
        likely = _most_probable(points[own, frames], seen[own], subspace)
        squared = np.sum((likely - points[own, frames]) ** 2, axis=2)
        distances = np.sqrt(np.sum(squared, axis=1, where=seen[own]) / (2 * counts[own]))
        # Perspective takes trajectories of other places and times than those that span the window out of the subspace.
        spans = counts[own] == seen.shape[1]
        num_windows[own] += spans
        num_far[own] += spans & (distances > max(_VERY_FAR * subspace.usual, params.min_stray))
        if subspace.noise >= params.min_noise:
            near = distances <= _FAR * subspace.noise
            own, likely = own[near], likely[near]
            total[own, frames] += counts[own, None, None] * likely
            weights[own, frames] += counts[own, None]
    changed = visible & (weights > 0)
    reduced = points.astype(np.float64)
    reduced[changed] = total[changed] / weights[changed, None]
    return CleanTrajectories(reduced, (num_far > 0) & (num_far == num_windows))


def _windows(visible: np.ndarray, params: NoiseReductionParams) -> list[slice]:
    """Return overlapping windows, shorter than most trajectories; none in a clip of few frames."""
    num_frames = visible.shape[1]
    lengths = visible.sum(axis=1)
    usual = int(params.window_share * np.median(lengths[lengths > 0])) if lengths.any() else 0
    length = min(max(usual, params.min_frames), params.max_frames)
    if num_frames <= params.max_frames and usual >= params.window_share * num_frames:
        length = num_frames
    if num_frames < length:
        return []
    starts = [*range(0, num_frames - length, max(1, length // 2)), num_frames - length]
    return [slice(start, start + length) for start in starts]


def _subspace_of(rows: np.ndarray, params: NoiseReductionParams) -> _Subspace | None:
    """Return the subspace of trajectories (n, D) seen in all frames; None if noise cannot be separated."""
    kept, found, size = np.ones(len(rows), bool), None, rows.shape[1]
    for _ in range(params.num_rounds):
        num = np.count_nonzero(kept)
        if num < params.min_tracks:
            return None
        mean = rows[kept].mean(axis=0)
        variances, vectors = np.linalg.eigh((rows[kept] - mean).T @ (rows[kept] - mean))
        singular = np.sqrt(np.maximum(variances[::-1], 0))[: min(num, size)]
        noise = _noise_of(singular, num, size)
        rank = int(np.count_nonzero(singular > noise * (np.sqrt(num) + np.sqrt(size))))
        if not 0 < rank < len(singular):
            return None
        basis = vectors[:, ::-1][:, :rank]
        centred = rows - mean
        residuals = np.sqrt(np.mean((centred - (centred @ basis) @ basis.T) ** 2, axis=1))
        usual = float(np.quantile(residuals, 0.25))
        signal = np.maximum(singular[:rank] ** 2 / num - noise**2, noise**2 / num)
        found = _Subspace(mean, basis, signal, noise, usual)
        still = residuals <= max(_FAR * usual, params.min_stray / 2)
        if np.array_equal(still, kept):
            break
        kept = still
    # Of random trajectories the smallest singular values are no noise.
    return found if len(found.variances) <= len(singular) // 2 else None


def _noise_of(singular: np.ndarray, num: int, dimension: int) -> float:
    """Return the noise of (num, dimension) entries whose smallest quarter of singular values is noise alone."""
    ratio = min(num, dimension) / max(num, dimension)
    low, high = (1 - np.sqrt(ratio)) ** 2, (1 + np.sqrt(ratio)) ** 2
    values = np.linspace(low, high, _SAMPLES + 2)[1:-1]
    share = np.cumsum(np.sqrt((high - values) * (values - low)) / values)
    quartile = values[np.searchsorted(share, 0.25 * share[-1])]
    return float(singular[-1 - len(singular) // 4] / np.sqrt(max(num, dimension) * quartile))


def _most_probable(points: np.ndarray, seen: np.ndarray, subspace: _Subspace) -> np.ndarray:
    """Return the most probable true points of trajectories (n, frame, xy), from those seen: the same shape."""
    weights = np.repeat(seen, 2, axis=1).astype(np.float64)
    centred = (points.reshape(len(points), -1) - subspace.mean) * weights
    normal = np.einsum("nd,dr,ds->nrs", weights, subspace.basis, subspace.basis, optimize=True)
    normal += np.diag(subspace.noise**2 / subspace.variances)
    coordinates = np.linalg.solve(normal, (centred @ subspace.basis)[..., None])[..., 0]
    return (subspace.mean + coordinates @ subspace.basis.T).reshape(points.shape)
