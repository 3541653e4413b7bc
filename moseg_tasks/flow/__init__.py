"""Dense optical flow between two frames."""

from moseg.tasks.flow.dis import estimate_flow

__all__ = ["estimate_flow"]
