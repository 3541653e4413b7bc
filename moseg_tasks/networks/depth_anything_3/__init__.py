"""Depth Anything 3: depth, and the cameras of several views, by a plain transformer (Lin et al. 2025)."""

from moseg.tasks.networks.depth_anything_3.build import (
    build_depth_anything_3,
    build_depth_anything_3_cameras,
    build_depth_anything_3_rays,
)
from moseg.tasks.networks.depth_anything_3.config import BASE, SMALL, DepthAnything3Config
from moseg.tasks.networks.depth_anything_3.network import DepthAnything3, DepthAnything3Views

__all__ = [
    "BASE",
    "SMALL",
    "DepthAnything3",
    "DepthAnything3Config",
    "DepthAnything3Views",
    "build_depth_anything_3",
    "build_depth_anything_3_cameras",
    "build_depth_anything_3_rays",
]
