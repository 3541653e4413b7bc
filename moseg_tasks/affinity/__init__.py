"""Motion affinity between objects."""

from moseg.tasks.affinity.estimate import estimate_affinity
from moseg.tasks.affinity.hypothesis_affinity import hypothesis_affinity
from moseg.tasks.affinity.ork import ork_affinity
from moseg.tasks.affinity.preferences import preference_kernel
from moseg.tasks.affinity.residual import residual_affinity
from moseg.tasks.affinity.static_support import static_support

__all__ = [
    "estimate_affinity",
    "hypothesis_affinity",
    "ork_affinity",
    "preference_kernel",
    "residual_affinity",
    "static_support",
]
