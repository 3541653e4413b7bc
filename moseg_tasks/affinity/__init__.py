"""Motion affinity between objects."""

from moseg.tasks.affinity.estimate import estimate_affinity
from moseg.tasks.affinity.hypotheses import fused_preferences, hypothesis_affinity, object_residuals
from moseg.tasks.affinity.object_samples import draw_object_samples
from moseg.tasks.affinity.ork import ork_affinity
from moseg.tasks.affinity.preferences import preferred_in_common, share_preferences
from moseg.tasks.affinity.residual import residual_affinity
from moseg.tasks.affinity.static_support import static_support

__all__ = [
    "draw_object_samples",
    "estimate_affinity",
    "fused_preferences",
    "hypothesis_affinity",
    "object_residuals",
    "ork_affinity",
    "preferred_in_common",
    "residual_affinity",
    "share_preferences",
    "static_support",
]
