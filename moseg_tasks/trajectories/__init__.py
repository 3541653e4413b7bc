"""Motion segmentation of trajectories: hypotheses of point models, ordered residual kernels, clusters."""

from moseg.tasks.trajectories.candidates import View
from moseg.tasks.trajectories.cluster import TrajectoryClustering, cluster_trajectories
from moseg.tasks.trajectories.kernel import trajectory_kernel
from moseg.tasks.trajectories.trajectory_hypotheses import Hypotheses, draw_hypotheses, hypothesis_residuals

__all__ = [
    "Hypotheses",
    "TrajectoryClustering",
    "View",
    "cluster_trajectories",
    "draw_hypotheses",
    "hypothesis_residuals",
    "trajectory_kernel",
]
