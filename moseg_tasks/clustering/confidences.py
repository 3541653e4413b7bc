"""The number of motions by four combined indices of cluster validity."""

from collections.abc import Sequence

import numpy as np

from moseg.tasks.clustering.spectral import embed_views

_SAME = 1e-9  # smaller differences of indices are rounding


def confidences(labelings: Sequence[np.ndarray], kernel: np.ndarray, eigenvalues: np.ndarray) -> np.ndarray:
    """Return indices of the clusterings into 2, 3, ... motions, float64 (len(labelings) - 1, 4); large is better.

    The relative eigengap, and the silhouette, the negative Davies-Bouldin index and the Calinski-Harabasz index of the
    spectral embedding in as many dimensions as there are motions. NaN if an index is not defined: for as many motions
    as objects, or fewer labels in use than motions.

    Parameters
    ----------
    labelings : sequence of int (K,)
        Into 1, 2, ... motions.
    kernel : float64 (K, K)
        The clustered affinity.
    eigenvalues : float64 (V, E)
        Eigenvalues of each view's normalised affinity, descending.

    References
    ----------
    P. Rousseeuw, "Silhouettes", 1987; D. Davies and D. Bouldin, "A cluster separation measure", 1979; T. Calinski and
    J. Harabasz, "A dendrite method for cluster analysis", 1974.
    """
    # Imported here because it takes half a second, see `cluster_many_points`.
    from sklearn.metrics import calinski_harabasz_score, davies_bouldin_score, silhouette_score

    spectrum = np.append(np.maximum(eigenvalues.mean(axis=0), 0.0), 0.0)
    rows = np.full((max(len(labelings) - 1, 0), 4), np.nan)
    for index, labels in enumerate(labelings[1:]):
        count = index + 2
        if len(np.unique(labels)) != count or count > len(kernel) - 1:
            continue
        points = embed_views(kernel[None], count).coordinates
        # Relative, because the spectrum falls in any case, most among the first eigenvalues.
        rows[index, 0] = (spectrum[count - 1] - spectrum[count]) / max(spectrum[count - 1], _SAME)
        rows[index, 1] = silhouette_score(points, labels)
        rows[index, 2] = -davies_bouldin_score(points, labels)
        rows[index, 3] = calinski_harabasz_score(points, labels)
    return rows


def combine_confidences(rows: np.ndarray, min_silhouette: float) -> np.ndarray:
    """Return the score of 1, 2, ... motions, float64 (len(rows) + 1,); the largest wins, excluded numbers have -1.

    Each index is scaled to 0..1 over the numbers of motions, and the scaled indices are averaged. None of them is
    defined for a single cluster: it wins if no silhouette reaches `min_silhouette`. This is rare, because the embedding
    of a static scene into k dimensions has k clusters as well.
    """
    known = np.isfinite(rows).all(axis=1)
    scores = np.full(len(rows) + 1, -1.0)
    if known.any():
        low, high = rows[known].min(axis=0), rows[known].max(axis=0)
        scaled = (rows[known] - low) / np.where(high - low > _SAME, high - low, 1.0)
        scores[1:][known] = scaled.mean(axis=1)
    if not known.any() or rows[known, 1].max() < min_silhouette:
        scores[0] = 2.0
    return scores
