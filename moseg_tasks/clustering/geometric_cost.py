"""The number of motions by the residuals of the tracks under rigid motions, with a fixed penalty per motion."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.tasks.clustering.epipolar_distances import EpipolarDistances, MotionDistances
from moseg.tasks.clustering.motion_tracks import MotionTracks


def geometric_costs(
    labelings: Sequence[np.ndarray],
    tracks: Sequence[MotionTracks],
    params: MotionCountParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return the cost of each labeling int (K,), float64: mean truncated squared distance and a penalty per motion.

    ``mean(min(d, tau)² / tau²) + l k`` with d the Sampson distance of an observation to the fundamental matrix of its
    motion in its frame pair, to a homography if the pair shows no parallax, or to an affine fundamental matrix for few
    points; with too few points for that, the cost of an observation is 1. The cost does not account for gains by
    chance: tau has to suit the noise and l the number of tracks.

    Parameters
    ----------
    labelings : sequence of int (K,)
    tracks : sequence of MotionTracks
    params : MotionCountParams
        `COUNT_READS` lists the parameters that are read; `truncation` is tau and `motion_price` l.
    rng : numpy.random.Generator
    """
    fits = EpipolarDistances(tracks, len(labelings[0]), params, rng)
    return np.array(
        [
            _mean_cost(fits.of(labels), params.truncation) + params.motion_price * len(np.unique(labels))
            for labels in labelings
        ]
    )


def _mean_cost(distances: MotionDistances, truncation: float) -> float:
    """Return the mean cost of an observation, 0..1; 0 if there is none."""
    if len(distances.fit) == 0:
        return 0.0
    distance = np.where(np.isinf(distances.full), distances.affine, distances.full)
    return float(np.mean(np.minimum(distance / truncation, 1.0) ** 2))
