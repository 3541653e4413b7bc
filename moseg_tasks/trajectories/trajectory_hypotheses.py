"""Hypotheses of a point model from minimal samples of trajectories."""

import math
from collections.abc import Sequence
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
    share fewer trajectories than a sample are ignored. If none shares enough, as in a clip of two frames, the gaps are
    reduced until one does. In a long clip, every second, third, ... set is used, so that a trajectory takes part in at
    most `params.max_sets` on average: time grows with the number of trajectories, not with their length.

    Parameters
    ----------
    points : float64 (track, frame, xy)
        px.
    visible : bool (track, frame)
    model : PointModel
    params : HypothesisParams
        `num_hypotheses`, `num_draws`, `gaps` and `max_sets` are read; the models of a draw are consecutive.
    rng : numpy.random.Generator

    Raises
    ------
    InputError
        If no set of frames shares enough trajectories.
    """
    parameters, frames, gaps = [], [], params.gaps
    while gaps and not frames:
        for chosen in _sampled_sets(visible, model.num_frames, gaps, params.max_sets):
            seen = np.flatnonzero(visible[:, chosen].all(axis=1))
            if len(seen) < model.sample_size:
                continue
            num_samples = params.num_draws * params.num_hypotheses
            samples = seen[_minimal_samples(len(seen), model.sample_size, num_samples, rng)]
            parameters.append(model.fit(Correspondences(points[samples][..., chosen, :])))
            frames.append(chosen)
        gaps = sorted({gap - 1 for gap in gaps} - {0})
    if not frames:
        raise InputError(
            f"too few trajectories for the {model.name} model",
            got=f"{len(points)} in {points.shape[1]} frames",
            expected=f"{model.sample_size} seen together in {model.num_frames} frames",
        )
    return Hypotheses(np.stack(parameters), np.array(frames, dtype=np.int32))


def _sampled_sets(visible: np.ndarray, size: int, gaps: Sequence[int], max_sets: int) -> list[list[int]]:
    """Return sets of `size` frames at equal distance: all, or every n-th of each gap."""
    num_frames = visible.shape[1]
    by_gap = [
        [list(range(first, first + size * gap, gap)) for first in range(num_frames - (size - 1) * gap)] for gap in gaps
    ]
    total = sum(np.count_nonzero(visible[:, chosen].all(axis=1)) for sets in by_gap for chosen in sets)
    stride = max(1, math.ceil(total / max(len(visible), 1) / max_sets))
    return [chosen for sets in by_gap for chosen in sets[::stride]]


def _minimal_samples(num_points: int, size: int, num_samples: int, rng: np.random.Generator) -> np.ndarray:
    """Draw indices (num_samples, size), different within a sample."""
    if num_points < 2 * size**2:
        return draw_samples(num_points, size, num_samples, rng)
    # Repetitions are rare among many points: drawing those samples again is faster than permutations.
    samples = rng.integers(num_points, size=(num_samples, size))
    while (repeated := (np.diff(np.sort(samples, axis=1), axis=1) == 0).any(axis=1)).any():
        samples[repeated] = rng.integers(num_points, size=(np.count_nonzero(repeated), size))
    return samples
