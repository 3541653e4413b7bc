"""Depth Anything 3: depth up to scale by a plain transformer (Lin et al. 2025)."""

from moseg.tasks.networks.depth_anything_3.build import build_depth_anything_3
from moseg.tasks.networks.depth_anything_3.config import BASE, SMALL, DepthAnything3Config
from moseg.tasks.networks.depth_anything_3.network import DepthAnything3

__all__ = ["BASE", "SMALL", "DepthAnything3", "DepthAnything3Config", "build_depth_anything_3"]
