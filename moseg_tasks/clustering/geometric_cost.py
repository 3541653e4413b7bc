"""The number of motions by how well rigid motions explain the tracks, at a fixed price for each."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.tasks.clustering.epipolar_distances import EpipolarDistances
from moseg.tasks.clustering.motion_tracks import MotionTracks


def geometric_costs(
    labelings: Sequence[np.ndarray],
    tracks: Sequence[MotionTracks],
    params: MotionCountParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """Cost of each labeling int (K,): mean truncated squared distance, and so much for each motion, float64.

    ``mean(min(d, tau)² / tau²) + l k`` with d the Sampson distance of an observation to the fundamental matrix of its
    motion in its frame pair, to a homography where the pair shows no parallax, or to an affine fundamental matrix where
    points are too few; where they are too few even for that, an observation costs 1. The cost does not see what it
    gains by chance: tau has to suit the noise and l the number of tracks.

    Parameters
    ----------
    labelings : sequence of int (K,)
    tracks : sequence of MotionTracks
    params : MotionCountParams
        What `COUNT_READS` names for ``geometric``; `truncation` is tau and `motion_price` l.
    rng : numpy.random.Generator
    """
    fits = EpipolarDistances(tracks, len(labelings[0]), params, rng)
    return np.array(
        [
            _mean_cost(fits.of(labels), params.truncation) + params.motion_price * len(np.unique(labels))
            for labels in labelings
        ]
    )


def _mean_cost(distances, truncation: float) -> float:
    """Of an observation, 0..1; 0 where there is none."""
    if len(distances.fit) == 0:
        return 0.0
    distance = np.where(np.isinf(distances.full), distances.affine, distances.full)
    return float(np.mean(np.minimum(distance / truncation, 1.0) ** 2))
