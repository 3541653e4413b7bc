"""Partitions of labelled trajectories into objects in three ways, each object of one motion by construction.

``one``: the background in 8 cells, each mover one object. ``two``: movers cut in two across their longer extent.
``big``: one large background object, 8 static patches beside it, each mover one object. The order of the objects is
random, because a nearly diagonal affinity reveals their order.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from sklearn.cluster import KMeans

from moseg.schemas.errors import MissingInputError
from moseg.workflows.sources.mat_tracks import decode_mat_tracks

PARTITIONS = ("one", "two", "big")
BACKGROUND = 1
"""GtLabel of the static background."""
NUM_CELLS = 8
PATCH_SHARE, PATCH_TRACKS = 0.4, 10
"""Share of a cell's trajectories in its patch, those nearest to its centre, and their minimum number."""
CUT_FROM = 16
"""Moving objects with fewer trajectories are not divided."""


class Clip(NamedTuple):
    """Trajectories: points (N, F, 2), px; visible (N, F); motion (N,), 0 = background."""

    points: np.ndarray
    visible: np.ndarray
    motion: np.ndarray


@dataclass(frozen=True, eq=False)
class Case:
    """Trajectories of a clip and their objects: owner (N,) of trajectories, motion (K,) of objects."""

    points: np.ndarray
    visible: np.ndarray
    owner: np.ndarray
    motion: np.ndarray

    @property
    def num_objects(self) -> int:
        return len(self.motion)

    @property
    def num_motions(self) -> int:
        return len(np.unique(self.motion))


def read_clips(root: Path) -> list[Clip]:
    """Read the clips ``<clip>_Tracks.mat`` of a folder in the order of their names."""
    files = sorted(root.glob("*_Tracks.mat"))
    if not files:
        raise MissingInputError("no clip", where=root, expected="<clip>_Tracks.mat of KT3DMoSeg")
    clips = []
    for file in files:
        points, visible, labels = decode_mat_tracks(file.read_bytes(), str(file))
        movers = [label for label in np.unique(labels) if label != BACKGROUND]
        motion = np.searchsorted(movers, labels) + 1
        motion[labels == BACKGROUND] = 0
        clips.append(Clip(points, visible, motion))
    return clips


def cases(clips: Iterable[Clip], partition: str, seed: int) -> list[Case]:
    """Return all clips under one partition; the same seed gives the same objects in the same order."""
    found = []
    for number, clip in enumerate(clips):
        rng = np.random.default_rng([seed, PARTITIONS.index(partition), number])
        found.append(Case(clip.points, clip.visible, *cut(clip, partition, rng)))
    return found


def cut(clip: Clip, partition: str, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return the object of each trajectory (N,) and the motion of each object (K,)."""
    seen = clip.visible[..., None]
    place = (clip.points * seen).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)
    background = np.flatnonzero(clip.motion == 0)
    cells = _cells(place[background], rng)
    groups = [background[cells == cell] for cell in range(NUM_CELLS)]
    if partition == "big":
        groups = [_centre(place, cell) for cell in groups]
        groups.append(np.setdiff1d(background, np.concatenate(groups)))
    for motion in range(1, clip.motion.max() + 1):
        mover = np.flatnonzero(clip.motion == motion)
        groups += _halves(place, mover) if partition == "two" and len(mover) >= CUT_FROM else [mover]
    groups = [groups[index] for index in rng.permutation(len(groups))]
    owner = np.zeros(len(clip.motion), np.int64)
    for index, group in enumerate(groups):
        owner[group] = index
    return owner, np.array([clip.motion[group[0]] for group in groups])


def _cells(place: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return the cell of each trajectory, by k-means of their mean places."""
    return KMeans(NUM_CELLS, n_init=1, random_state=int(rng.integers(2**31))).fit(place).labels_


def _centre(place: np.ndarray, cell: np.ndarray) -> np.ndarray:
    """Return the trajectories of a cell nearest to its centre."""
    distance = np.linalg.norm(place[cell] - place[cell].mean(axis=0), axis=1)
    return cell[np.argsort(distance)[: max(round(PATCH_SHARE * len(cell)), min(PATCH_TRACKS, len(cell)))]]


def _halves(place: np.ndarray, mover: np.ndarray) -> list[np.ndarray]:
    """Return a moving object's trajectories, halved across its longer extent."""
    centred = place[mover] - place[mover].mean(axis=0)
    along = centred @ np.linalg.svd(centred, full_matrices=False)[2][0]
    order = mover[np.argsort(along, kind="stable")]
    return [order[: len(order) // 2], order[len(order) // 2 :]]
