"""Cuts between scenes: frames of which next to nothing is seen in the frame before."""

from moseg.tasks.scene_cuts.find import find_cuts

__all__ = ["find_cuts"]
