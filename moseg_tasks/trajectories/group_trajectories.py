"""Motion groups of all trajectories of a clip: landmarks without outliers are clustered, the others join them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import TrajectoryClusteringParams
from moseg.tasks.point_models import PointModel
from moseg.tasks.trajectories.candidates import View
from moseg.tasks.trajectories.cluster import TrajectoryClustering, cluster_trajectories
from moseg.tasks.trajectories.hypothesis_residuals import HypothesisResiduals
from moseg.tasks.trajectories.landmarks import assign_motions, choose_landmarks
from moseg.tasks.trajectories.outliers import find_outliers, join_outliers
from moseg.tasks.trajectories.subspace_distances import subspace_distances
from moseg.tasks.trajectories.trajectory_hypotheses import Hypotheses


class ModelKernels(NamedTuple):
    """Hypotheses of one point model, and the kernels float32 (D, M, M) of D draws between M landmarks.

    `codes`, uint16 (S, M, H), are those of the landmarks (`HypothesisResiduals.all_codes`) if they are known.
    """

    model: PointModel
    hypotheses: Hypotheses
    kernels: np.ndarray
    codes: np.ndarray | None = None

    def of_landmarks(self, chosen: np.ndarray) -> "ModelKernels":
        """Return the same for some of the landmarks, int (m,)."""
        if len(chosen) == self.kernels.shape[1]:
            return self
        codes = None if self.codes is None else self.codes[:, chosen]
        # One axis after the other takes a quarter of the time.
        return self._replace(kernels=self.kernels[:, chosen].take(chosen, axis=2), codes=codes)

    def with_codes(self, points: np.ndarray, visible: np.ndarray) -> "ModelKernels":
        """Return the same with the codes, which are computed if they are not known; without them if too large.

        The codes of fewer landmarks would have other roundings, and results would depend on what is known.
        """
        return self._replace(codes=self.residuals(points, visible).all_codes())

    def residuals(self, points: np.ndarray, visible: np.ndarray) -> HypothesisResiduals:
        """Return the residuals of the landmarks."""
        return HypothesisResiduals(self.hypotheses, points, visible, self.model, self.codes)


class TrajectoryGroups(NamedTuple):
    """Motion groups of N trajectories.

    Attributes
    ----------
    motion : uint16 (N,)
    clustering : TrajectoryClustering
        Of the landmarks that are no outliers.
    num_outliers : int
    """

    motion: np.ndarray
    clustering: TrajectoryClustering
    num_outliers: int


def group_trajectories(
    points: np.ndarray,
    visible: np.ndarray,
    views: Sequence[ModelKernels],
    num_motions: int | None,
    params: TrajectoryClusteringParams,
    window: float,
    rng: np.random.Generator,
) -> TrajectoryGroups:
    """Group all trajectories of a clip by motion.

    Outliers are set aside for clustering by energy; the published methods cluster all.

    Parameters
    ----------
    points : float64 (N, frame, xy)
        px.
    visible : bool (N, frame)
    views : sequence of ModelKernels
        From the least general model to the most; kernels are those of `choose_landmarks`.
    num_motions : int, optional
        None: it is found.
    params : TrajectoryClusteringParams
    window : float
        Share of a set's hypotheses that a trajectory prefers.
    rng : numpy.random.Generator
    """
    num_draws, num_landmarks = views[0].kernels.shape[:2]
    landmarks = choose_landmarks(points, visible, num_landmarks)
    mean = np.mean([view.kernels.mean(axis=0) for view in views], axis=0)
    sets_outliers_aside = params.method == "energy"
    is_outlier = np.zeros(num_landmarks, bool)
    if sets_outliers_aside:
        residuals = views[-1].residuals(points[landmarks], visible[landmarks])
        distances = residuals.draws(num_draws)[0].nearest_distances(window)
        is_outlier = find_outliers(mean, distances, params.outliers)
    kept = np.flatnonzero(~is_outlier)
    own_points, own_visible = points[landmarks[kept]], visible[landmarks[kept]]
    by_view = []
    for view in views:
        own = view.of_landmarks(kept)
        by_view.append(list(map(View, own.kernels, own.residuals(own_points, own_visible).draws(num_draws))))
    draws = list(zip(*by_view, strict=True))
    clustering = cluster_trajectories(draws, own_points, own_visible, num_motions, params, rng)
    motion = clustering.motion
    if sets_outliers_aside:
        labels = np.full(num_landmarks, -1)
        labels[kept] = motion
        distances = subspace_distances(points[landmarks], visible[landmarks], labels, params.energy.coding)
        motion = join_outliers(mean, is_outlier, motion, distances, params.outliers)
    if len(landmarks) < len(points):
        everything = [HypothesisResiduals(view.hypotheses, points, visible, view.model) for view in views]
        motion = assign_motions(landmarks, motion, everything, window).astype(np.uint16)
    return TrajectoryGroups(motion, clustering, int(np.count_nonzero(is_outlier)))
