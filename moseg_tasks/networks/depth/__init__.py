"""Networks of monocular depth."""

from moseg.tasks.networks.depth.depth_anything import build_depth_anything
from moseg.tasks.networks.depth.dpt_dinov2 import DptDinov2, build_dpt_dinov2
from moseg.tasks.networks.depth.positions import PATCH

__all__ = ["PATCH", "DptDinov2", "build_depth_anything", "build_dpt_dinov2"]
