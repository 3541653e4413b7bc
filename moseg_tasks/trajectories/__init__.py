"""Motion segmentation of trajectories: hypotheses of point models, ordered residual kernels, clusters."""

from moseg.tasks.trajectories.candidates import View
from moseg.tasks.trajectories.clip_sections import group_clip
from moseg.tasks.trajectories.cluster import TrajectoryClustering, cluster_trajectories
from moseg.tasks.trajectories.group_trajectories import ModelKernels, TrajectoryGroups, group_trajectories
from moseg.tasks.trajectories.hypothesis_residuals import HypothesisResiduals
from moseg.tasks.trajectories.kernel import trajectory_kernels
from moseg.tasks.trajectories.landmarks import assign_motions, choose_landmarks
from moseg.tasks.trajectories.noise_reduction import reduce_noise
from moseg.tasks.trajectories.trajectory_hypotheses import Hypotheses, draw_hypotheses

__all__ = [
    "Hypotheses",
    "HypothesisResiduals",
    "ModelKernels",
    "TrajectoryClustering",
    "TrajectoryGroups",
    "View",
    "assign_motions",
    "choose_landmarks",
    "cluster_trajectories",
    "draw_hypotheses",
    "group_clip",
    "group_trajectories",
    "reduce_noise",
    "trajectory_kernels",
]
