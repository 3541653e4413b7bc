"""Relative inverse depth of single frames."""

from moseg.tasks.depth.estimate import estimate_inverse_depth

__all__ = ["estimate_inverse_depth"]
