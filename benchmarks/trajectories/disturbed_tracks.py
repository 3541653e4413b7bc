"""Labelled trajectories of a data set, and ways to disturb them: random tracks, noise and missing entries."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.datasets import open_dataset

OUTLIER = 0
"""Label of a trajectory that follows no motion; it is not scored."""
MIN_FRAMES = 5
"""Frames that a trajectory keeps when entries are removed."""


class Clip(NamedTuple):
    """Trajectories: points float64 (N, F, 2), px; visible bool (N, F); labels int (N,), 0 = not scored."""

    name: str
    points: np.ndarray
    visible: np.ndarray
    labels: np.ndarray


def read_clips(dataset: str, root: str, every: int) -> Iterator[Clip]:
    """Yield every n-th clip of a data set."""
    opened = open_dataset(dataset, root, max_side=PipelineConfig().max_side)
    for name in opened.names[::every]:
        source = opened.trajectories(name)
        points, visible = source.trajectories.read()
        yield Clip(name, points, visible, source.labels.read().astype(np.int64))


def add_outliers(clip: Clip, share: float, rng: np.random.Generator) -> Clip:
    """Add random walks such that they are this share of all trajectories.

    A walk starts anywhere among the points. The lengths of its steps are those of true ones and their directions are
    random; it is visible as long as one of the true ones.
    """
    num_outliers = round(share / (1 - share) * len(clip.points))
    seen = clip.visible[:, 1:] & clip.visible[:, :-1]
    lengths = np.linalg.norm(np.diff(clip.points, axis=1), axis=2)[seen]
    steps = rng.choice(lengths, (num_outliers, seen.shape[1]))
    angles = rng.uniform(0, 2 * np.pi, steps.shape)
    moves = steps[..., None] * np.stack([np.cos(angles), np.sin(angles)], axis=2)
    low, high = clip.points[clip.visible].min(axis=0), clip.points[clip.visible].max(axis=0)
    start = rng.uniform(low, high, (num_outliers, 1, 2))
    walks = np.concatenate([start, start + np.cumsum(moves, axis=1)], axis=1)
    visible = clip.visible[rng.integers(len(clip.points), size=num_outliers)]
    return clip._replace(
        points=np.concatenate([clip.points, walks]),
        visible=np.concatenate([clip.visible, visible]),
        labels=np.concatenate([clip.labels, np.full(num_outliers, OUTLIER)]),
    )


def add_noise(clip: Clip, sigma: float, rng: np.random.Generator) -> Clip:
    """Add normal noise of standard deviation `sigma`, px, to every coordinate."""
    return clip._replace(points=clip.points + rng.normal(0, sigma, clip.points.shape))


def remove_entries(clip: Clip, share: float, rng: np.random.Generator) -> Clip:
    """Hide this share of each trajectory's frames, in one stretch at its start or at its end, as tracks are lost."""
    visible = clip.visible.copy()
    for row in visible:
        frames = np.flatnonzero(row)
        num_hidden = min(round(share * len(frames)), max(len(frames) - MIN_FRAMES, 0))
        # Some start late and some end early, so that not all are seen in the same frames.
        late = rng.integers(num_hidden + 1)
        row[frames[:late]] = False
        row[frames[len(frames) - (num_hidden - late) :]] = False
    return clip._replace(visible=visible)


DISTURBANCES = {
    "outliers": (add_outliers, (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5)),
    "noise": (add_noise, (0.0, 0.25, 0.5, 1.0, 1.5, 2.0)),
    "missing": (remove_entries, (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)),
}
"""Functions and their measured strengths: shares, or px."""
