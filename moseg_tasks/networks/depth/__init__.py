"""Networks of monocular depth."""

from moseg_tasks.networks.depth.depth_anything import build_depth_anything
from moseg_tasks.networks.depth.dpt_dinov2 import DptDinov2, build_dpt_dinov2

__all__ = ["DptDinov2", "build_depth_anything", "build_dpt_dinov2"]
