"""The number of motions by cluster stability: the agreement of clusterings of resampled frame pairs."""

import itertools
from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.tasks.affinity import hypothesis_affinity
from moseg.tasks.clustering.fusion import fill_unknown
from moseg.tasks.clustering.motion_tracks import MotionTracks, check_tracks, frame_pairs


def resampled_affinities(
    tracks: Sequence[MotionTracks], num_owners: int, params: MotionCountParams, rng: np.random.Generator
) -> list[np.ndarray]:
    """Return affinities from many hypotheses, each from a random half of the frame pairs, float64 (K, K) without NaN.

    Parameters
    ----------
    tracks : sequence of MotionTracks
    num_owners : int
        K.
    params : MotionCountParams
        `gap`, `affinity` and `num_resamples` are read.
    rng : numpy.random.Generator
    """
    for section in tracks:
        check_tracks(section, num_owners)
    resampled = []
    for _ in range(params.num_resamples):
        views = [_half(section, num_owners, params, rng) for section in tracks]
        resampled.append(fill_unknown([fill_unknown(views).mean(axis=0)])[0] if views else np.ones((num_owners,) * 2))
    return resampled


def stability_scores(resampled: Sequence[Sequence[np.ndarray]], min_agreement: float) -> np.ndarray:
    """Return the score of 1, 2, ... motions; the largest wins: the number on which the resamples agree best.

    A single group always agrees with itself, so its score is `min_agreement`: it wins if no other number exceeds that.
    Clusters of a static scene, for example by depth, are stable too, and are then counted as motions.

    Parameters
    ----------
    resampled : sequence of sequences of int (K,)
        Each resample's clusterings into 1, 2, ... motions.
    min_agreement : float
        Mean adjusted Rand index between two resamples, 1 where they are equal and about 0 by chance.

    Returns
    -------
    float64 (len(resampled[0]),)

    References
    ----------
    U. von Luxburg, "Clustering stability: an overview", Foundations and Trends in Machine Learning 2, 2010.
    """
    agreements = [_mean_agreement(labelings) for labelings in zip(*resampled, strict=True)]
    return np.array([min_agreement, *agreements[1:]])


def _mean_agreement(labelings: Sequence[np.ndarray]) -> float:
    """Return the mean adjusted Rand index over pairs of labelings; 1 for a single one."""
    # Imported here because it takes half a second, see `cluster_many_points`.
    from sklearn.metrics import adjusted_rand_score

    pairs = list(itertools.combinations(labelings, 2))
    return float(np.mean([adjusted_rand_score(*pair) for pair in pairs])) if pairs else 1.0


def _half(section: MotionTracks, num_owners: int, params: MotionCountParams, rng: np.random.Generator) -> np.ndarray:
    """Return the affinity of a section from a random half of its frame pairs."""
    pairs = np.array(frame_pairs(section.points.shape[1], params.gap), dtype=np.intp).reshape(-1, 2)
    kept = np.sort(rng.permutation(len(pairs))[: (len(pairs) + 1) // 2])
    # First frames, then second frames, so that all pairs have the same gap.
    frames = pairs[kept].T.ravel()
    apart = params.affinity.model_copy(update={"gap": max(len(kept), 1)})
    return hypothesis_affinity(
        section.points[:, frames], section.visible[:, frames], section.owner, num_owners, apart, rng
    )
