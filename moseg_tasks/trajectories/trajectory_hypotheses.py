"""Hypotheses of a point model from minimal samples of trajectories."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import HypothesisParams
from moseg.tasks.geometry.ransac import draw_samples
from moseg.tasks.point_models import Correspondences, PointModel


class Hypotheses(NamedTuple):
    """Models fitted to minimal samples.

    Attributes
    ----------
    parameters : float64 (S, H, *P)
        H models of each of S sets of frames, in pixel coordinates.
    frames : int32 (S, num_frames)
        The frames of each set.
    """

    parameters: np.ndarray
    frames: np.ndarray


def draw_hypotheses(
    points: np.ndarray, visible: np.ndarray, model: PointModel, params: HypothesisParams, rng: np.random.Generator
) -> Hypotheses:
    """Fit a model to minimal samples of the trajectories seen in all frames of each set.

    A set is `model.num_frames` frames at equal distance, one for each first frame and each of `params.gaps`; sets that
    share fewer trajectories than a sample are ignored.

    Parameters
    ----------
    points : float64 (track, frame, xy)
        px.
    visible : bool (track, frame)
    model : PointModel
    params : HypothesisParams
        `num_hypotheses`, `num_draws` and `gaps` are read; the models of a draw are consecutive.
    rng : numpy.random.Generator

    Raises
    ------
    InputError
        If no set of frames shares enough trajectories.
    """
    parameters, frames = [], []
    for chosen in _frame_sets(points.shape[1], model.num_frames, params.gaps):
        seen = np.flatnonzero(visible[:, chosen].all(axis=1))
        if len(seen) < model.sample_size:
            continue
        num_samples = params.num_draws * params.num_hypotheses
        samples = seen[_minimal_samples(len(seen), model.sample_size, num_samples, rng)]
        parameters.append(model.fit(Correspondences(points[samples][..., chosen, :])))
        frames.append(chosen)
    if not frames:
        gaps = ", ".join(map(str, params.gaps))
        raise InputError(
            f"too few trajectories for the {model.name} model",
            got=f"{len(points)} in {points.shape[1]} frames",
            expected=f"{model.sample_size} seen together in {model.num_frames} frames at gaps {gaps}",
        )
    return Hypotheses(np.stack(parameters), np.array(frames, dtype=np.int32))


def _frame_sets(num_frames: int, size: int, gaps: tuple[int, ...]) -> list[list[int]]:
    """Return all sets of `size` frames at equal distance."""
    return [
        list(range(first, first + size * gap, gap)) for gap in gaps for first in range(num_frames - (size - 1) * gap)
    ]


def _minimal_samples(num_points: int, size: int, num_samples: int, rng: np.random.Generator) -> np.ndarray:
    """Draw indices (num_samples, size), different within a sample."""
    if num_points < 2 * size**2:
        return draw_samples(num_points, size, num_samples, rng)
    # Repetitions are rare among many points: drawing those samples again is faster than permutations.
    samples = rng.integers(num_points, size=(num_samples, size))
    while (repeated := (np.diff(np.sort(samples, axis=1), axis=1) == 0).any(axis=1)).any():
        samples[repeated] = rng.integers(num_points, size=(np.count_nonzero(repeated), size))
    return samples
