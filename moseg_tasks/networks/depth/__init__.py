"""Networks of monocular depth."""

from moseg_tasks.networks.depth.depth_anything import build_depth_anything
from moseg_tasks.networks.depth.dpt_dinov2 import build_dpt_dinov2

__all__ = ["build_depth_anything", "build_dpt_dinov2"]
