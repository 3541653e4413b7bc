"""Stand-ins for the sequences of a data set that are not on disk, so that a set of its published size can be timed."""

from itertools import accumulate, cycle, islice, pairwise
from pathlib import Path

import numpy as np
from disturbed_tracks import Clip, read_clips
from scipy.io import savemat

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.datasets import open_dataset
from moseg.workflows.datasets.labelled_tracks import TRUTH_SUFFIX

SHIFT = 0.5
"""Pixels by which a stand-in is moved, so that none of its artifacts is that of another sequence."""


def write_stand_ins(dataset: str, root: str, folder: Path, num_tracks: int) -> None:
    """Write a sequence in Hopkins155's layout into a folder for each that is missing.

    The sequences on disk stand in for the missing ones in turn, moved by half a pixel (by one pixel if a sequence
    stands in a second time, and so on). All have the same share of their trajectories, such that the data set has
    `num_tracks` in all; of each motion too it is that share.
    """
    missing = open_dataset(dataset, root, max_side=PipelineConfig().max_side).absent
    if not missing:
        raise SystemExit(f"{dataset}: nothing is missing in {root}")
    clips = list(read_clips(dataset, root, every=1))
    sources = list(islice(cycle(clips), len(missing)))
    num_here, num_sources = (sum(len(clip.labels) for clip in each) for each in (clips, sources))
    share = (num_tracks - num_here) / num_sources
    if not 0 < share <= 1:
        wanted = f"more than {num_here} and at most {num_here + num_sources}"
        raise SystemExit(f"{dataset}: {num_tracks} trajectories in all; expected {wanted}")
    ends = accumulate((share * len(clip.labels) for clip in sources), initial=0.0)
    for place, (name, clip, (start, end)) in enumerate(zip(missing, sources, pairwise(ends), strict=True)):
        chosen = _spread(clip, round(end) - round(start))
        _write(folder / f"{name}{TRUTH_SUFFIX}", clip, chosen, SHIFT * (1 + place // len(clips)))


def _spread(clip: Clip, number: int) -> np.ndarray:
    """Return this number of trajectories, int (number,), at even distances in the order of their motions."""
    by_motion = np.argsort(clip.labels, kind="stable")
    return np.sort(by_motion[np.linspace(0, len(by_motion) - 1, number).round().astype(int)])


def _write(path: Path, clip: Clip, chosen: np.ndarray, shift: float) -> None:
    points = clip.points[chosen] + shift
    homogeneous = np.concatenate([points, np.ones((*points.shape[:2], 1))], axis=2).transpose(2, 0, 1)
    savemat(path, {"y": homogeneous, "s": clip.labels[chosen][:, None], "m": clip.visible[chosen].astype(np.uint8)})
