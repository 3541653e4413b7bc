"""Distances of tracks to the two-view geometries of the motions of a labeling."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.tasks.clustering.affine_epipolar import affine_epipolar_distances
from moseg.tasks.clustering.motion_tracks import MotionTracks, check_tracks, frame_pairs
from moseg.tasks.geometry.degeneracy import point_spread
from moseg.tasks.geometry.homography import homography_sampson_squared
from moseg.tasks.geometry.poselib_fundamental import poselib_fundamental
from moseg.tasks.geometry.ransac import HOMOGRAPHY, RobustFit, ransac
from moseg.tasks.geometry.sampson import sampson_squared

_FUNDAMENTAL_POINTS = 8  # a fundamental matrix fits seven exactly
_HOMOGRAPHY_POINTS = 5  # and a homography four


class MotionDistances(NamedTuple):
    """Distances of the M observations, tracks visible in both frames of a pair, to their motion's models.

    Attributes
    ----------
    fit : int (M,)
        Motion and frame pair of each observation, numbered from 0.
    full : float64 (M,)
        Sampson distance, px, to the motion's fundamental matrix, or to its homography if the pair shows no parallax;
        infinite for motions of too few points.
    affine : float64 (M,)
        Sampson distance to an affine fundamental matrix; also infinite if the pair shows no parallax.
    is_flat : bool (M,)
        Whether the pair shows no parallax.
    """

    fit: np.ndarray
    full: np.ndarray
    affine: np.ndarray
    is_flat: np.ndarray


class _Pair(NamedTuple):
    """The observations of one frame pair."""

    points0: np.ndarray
    points1: np.ndarray
    owner: np.ndarray
    start: int
    """Number of its first observation among those of all pairs."""
    is_flat: bool


class EpipolarDistances:
    """Two-view geometries fitted to the motions of labelings; groups that labelings share are fitted once.

    If a homography explains an object that spans the scene, in most pairs, the camera is still or only rotates. A
    fundamental matrix is then not determined and can explain a mover together with the static scene, so homographies
    replace it. An object that does not span the scene may be flat itself.

    Parameters
    ----------
    tracks : sequence of MotionTracks
        Sections of a video; pairs of frames lie inside a section.
    num_owners : int
        K.
    params : MotionCountParams
        `COUNT_READS` lists the parameters that are read.
    rng : numpy.random.Generator

    Raises
    ------
    InputError
        If the tracks have a wrong shape or an owner outside 0 .. K - 1.
    """

    def __init__(
        self, tracks: Sequence[MotionTracks], num_owners: int, params: MotionCountParams, rng: np.random.Generator
    ):
        self._params = params
        # One seed for all fits: the fit of a group must not depend on earlier fits.
        self._seed = int(rng.integers(2**31))
        self._fits: dict[bytes, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
        self._pairs: list[_Pair] = []
        self.num_observations = 0
        for section in tracks:
            check_tracks(section, num_owners)
            self._pairs += self._pairs_of(section)

    def of(self, labels: np.ndarray) -> MotionDistances:
        """Return the distances to the motions of a labeling int (K,)."""
        fit = np.empty(self.num_observations, np.int64)
        full, affine = np.empty((2, self.num_observations))
        for number, label in enumerate(np.unique(labels)):
            members = labels == label
            key = members.tobytes()
            if key not in self._fits:
                self._fits[key] = self._fit(members)
            where, full_distance, affine_distance = self._fits[key]
            full[where], affine[where], fit[where] = full_distance, affine_distance, number
        sizes = [len(pair.owner) for pair in self._pairs]
        pair = np.repeat(np.arange(len(sizes)), sizes)
        is_flat = np.repeat(np.array([pair.is_flat for pair in self._pairs], dtype=bool), sizes)
        return MotionDistances(np.unique(fit * len(sizes) + pair, return_inverse=True)[1], full, affine, is_flat)

    def _pairs_of(self, section: MotionTracks) -> list[_Pair]:
        """Return the pairs of a section; if most show parallax, all are treated as such."""
        pairs = []
        for frame0, frame1 in frame_pairs(section.points.shape[1], self._params.gap):
            seen = section.visible[:, frame0] & section.visible[:, frame1]
            points0, points1 = section.points[seen][:, [frame0, frame1]].astype(np.float64).transpose(1, 0, 2)
            owner = section.owner[seen]
            is_flat = self._is_flat(points0, points1, owner, len(self._pairs) + len(pairs))
            pairs.append(_Pair(points0, points1, owner, self.num_observations, is_flat))
            self.num_observations += len(owner)
        if sum(pair.is_flat for pair in pairs) > len(pairs) / 2:
            return pairs
        return [pair._replace(is_flat=False) for pair in pairs]

    def _is_flat(self, points0: np.ndarray, points1: np.ndarray, owner: np.ndarray, number: int) -> bool:
        """Return whether a homography explains the object of widest spread, if that is wide enough."""
        objects = [owner == index for index in np.flatnonzero(np.bincount(owner) >= _FUNDAMENTAL_POINTS)]
        if not objects:
            return False
        widest = max(objects, key=lambda own: point_spread(points0[own]))
        if point_spread(points0[widest]) < self._params.least_span * point_spread(points0):
            return False
        fundamental = self._fundamental(points0[widest], points1[widest], number)
        homography = self._homography(points0[widest], points1[widest], number)
        if fundamental is None:
            return True
        return homography.inlier_mask.sum() >= self._params.homography_ratio * fundamental.inlier_mask.sum()

    def _fit(self, members: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the numbers of the members' observations, and their distances to a fit of each kind."""
        found: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = [(np.empty(0, np.int64), np.empty(0), np.empty(0))]
        for number, pair in enumerate(self._pairs):
            own = np.flatnonzero(members[pair.owner])
            points = pair.points0[own], pair.points1[own]
            full, affine = np.full((2, len(own)), np.inf)
            if pair.is_flat:
                if len(own) >= _HOMOGRAPHY_POINTS:
                    full = np.sqrt(homography_sampson_squared(self._homography(*points, number).matrix, *points))
            else:
                fit = self._fundamental(*points, number) if len(own) >= _FUNDAMENTAL_POINTS else None
                full = full if fit is None else np.sqrt(sampson_squared(fit.matrix, *points))
                distance = self._affine(*points, number)
                affine = affine if distance is None else distance
            found.append((pair.start + own, full, affine))
        where, full, affine = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return where, full, affine

    def _fundamental(self, points0: np.ndarray, points1: np.ndarray, number: int) -> RobustFit | None:
        """Fit a fundamental matrix to the points of pair `number`."""
        return poselib_fundamental(
            points0,
            points1,
            threshold=self._params.threshold,
            num_samples=self._params.num_samples,
            rng=np.random.default_rng([self._seed, number]),
        )

    def _homography(self, points0: np.ndarray, points1: np.ndarray, number: int) -> RobustFit:
        """Fit a homography to the points of pair `number`."""
        return ransac(
            HOMOGRAPHY,
            points0,
            points1,
            threshold=self._params.threshold,
            num_samples=self._params.num_samples,
            num_refits=self._params.num_refits,
            rng=np.random.default_rng([self._seed, number, 1]),
        )

    def _affine(self, points0: np.ndarray, points1: np.ndarray, number: int) -> np.ndarray | None:
        """Return distances to an affine fundamental matrix fitted to the points of pair `number`."""
        return affine_epipolar_distances(
            points0,
            points1,
            threshold=self._params.truncation,
            num_samples=self._params.num_samples,
            rng=np.random.default_rng([self._seed, number, 2]),
        )
