"""Motion segmentation of trajectories: hypotheses of point models, ordered residual kernels, clusters."""

from moseg_tasks.trajectories.candidates import View
from moseg_tasks.trajectories.cluster import TrajectoryClustering, cluster_trajectories
from moseg_tasks.trajectories.hypotheses import Hypotheses, draw_hypotheses, hypothesis_residuals
from moseg_tasks.trajectories.kernel import trajectory_kernel

__all__ = [
    "Hypotheses",
    "TrajectoryClustering",
    "View",
    "cluster_trajectories",
    "draw_hypotheses",
    "hypothesis_residuals",
    "trajectory_kernel",
]
