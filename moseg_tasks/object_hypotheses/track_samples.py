"""Two-view models of minimal samples of a frame's tracks, and the residuals of every object under them."""

import numpy as np

from moseg.schemas.parameters import ObjectHypothesisParams
from moseg.tasks.geometry.ransac import draw_samples
from moseg.tasks.point_models import POINT_MODELS, Correspondences, sample_residuals

TRACK_MODELS = ("fundamental", "homography")
"""The first does not detect motion along epipolar lines; the second detects all motion, but also parallax."""


def track_sample_residuals(
    points0: np.ndarray,
    points1: np.ndarray,
    nodes: np.ndarray,
    num_nodes: int,
    min_points: int,
    params: ObjectHypothesisParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return the median squared distance of every node's tracks to models of samples from the whole frame.

    A sample of mixed motions explains none of them. Samples drawn inside objects would have one motion, but their
    models would not be determined outside the objects.

    Parameters
    ----------
    points0, points1 : float (T, 2)
        xy of the tracks visible in both frames of a pair, px.
    nodes : integer (T,)
        Object or part of the background of each track.
    num_nodes : int
        N.
    min_points : int
        Nodes with fewer tracks are ignored.
    params : ObjectHypothesisParams
    rng : numpy.random.Generator

    Returns
    -------
    float64 (2, num_hypotheses, N)
        px², in the order of `TRACK_MODELS`; NaN for ignored nodes, and for all nodes if the frame has too few tracks
        for a sample.
    """
    residual = np.full((len(TRACK_MODELS), params.num_hypotheses, num_nodes), np.nan)
    tracks = Correspondences(np.stack([points0, points1], axis=1).astype(np.float64))
    min_tracks = np.full(num_nodes, min_points)
    for index, name in enumerate(TRACK_MODELS):
        model = POINT_MODELS[name]
        if tracks.num_points >= model.sample_size:
            samples = draw_samples(tracks.num_points, model.sample_size, params.num_hypotheses, rng)
            residual[index] = sample_residuals(tracks, nodes, min_tracks, model, samples)
    return residual
