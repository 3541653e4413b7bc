"""Residuals of objects under point models fitted to samples of tracks."""

import numpy as np

from moseg.tasks.point_models.correspondences import Correspondences
from moseg.tasks.point_models.point_model import PointModel


def sample_residuals(
    tracks: Correspondences, owner: np.ndarray, min_tracks: np.ndarray, model: PointModel, samples: np.ndarray
) -> np.ndarray:
    """Return the median squared distance of each object's tracks to the models of samples.

    Parameters
    ----------
    tracks : Correspondences
        N tracks visible in all frames of the model.
    owner : integer (N,)
        Object of each track.
    min_tracks : int (K,)
        Objects with fewer tracks are ignored.
    model : PointModel
    samples : intp (H, S)
        Tracks of each sample.

    Returns
    -------
    float64 (H, K)
        px²; NaN for ignored objects.
    """
    residual = np.full((len(samples), len(min_tracks)), np.nan)
    # In single precision, because only the order of distances is used; overflows count as the largest.
    with np.errstate(over="ignore"):
        squared = model.residual(model.fit(tracks.take(samples)), tracks, np.float32)
    for index, num_required in enumerate(min_tracks):
        own = np.flatnonzero(owner == index)
        if len(own) >= num_required:
            residual[:, index] = np.median(squared[:, own], axis=1)
    return residual
