"""Motion affinity between objects."""

from moseg_tasks.affinity.estimate import estimate_affinity
from moseg_tasks.affinity.ork import ork_affinity
from moseg_tasks.affinity.residual import residual_affinity
from moseg_tasks.affinity.static_support import static_support

__all__ = ["estimate_affinity", "ork_affinity", "residual_affinity", "static_support"]
