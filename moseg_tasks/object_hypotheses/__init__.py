"""Comparison of objects by their ranks of many motion hypotheses of the whole frame."""

from moseg.tasks.affinity import preference_kernel
from moseg.tasks.object_hypotheses.background_cells import (
    background_cells,
    geometric_mean,
    scale_by_background,
    split_background,
)
from moseg.tasks.object_hypotheses.flow_patches import flow_patch_residuals
from moseg.tasks.object_hypotheses.track_samples import track_sample_residuals

__all__ = [
    "background_cells",
    "flow_patch_residuals",
    "geometric_mean",
    "preference_kernel",
    "scale_by_background",
    "split_background",
    "track_sample_residuals",
]
