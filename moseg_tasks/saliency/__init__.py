"""Motion saliency of frames without any learned weights, and its accumulation over time."""

from moseg_tasks.saliency.accumulation import accumulate_saliency
from moseg_tasks.saliency.frame import FrameSaliency, estimate_saliency
from moseg_tasks.saliency.grid import working_shape

__all__ = ["FrameSaliency", "accumulate_saliency", "estimate_saliency", "working_shape"]
