"""Motion saliency without learned weights: from the flow of frame pairs to each pixel's probability to move."""

from moseg.tasks.saliency.accumulation import accumulate, memory_weight
from moseg.tasks.saliency.background import AffineMotion
from moseg.tasks.saliency.choice import BackgroundChoice, choose_background
from moseg.tasks.saliency.consistency import flow_consistency
from moseg.tasks.saliency.flow_growth import flow_growth
from moseg.tasks.saliency.foreground import foreground_probability
from moseg.tasks.saliency.frame import FrameSaliency, estimate_saliency
from moseg.tasks.saliency.logits import motion_logit, probability
from moseg.tasks.saliency.motion_memory import motion_odds, remembered_logit
from moseg.tasks.saliency.moves_now import moves_now
from moseg.tasks.saliency.own_motion import own_motion_misfit
from moseg.tasks.saliency.shared_motion import share_out

__all__ = [
    "AffineMotion",
    "BackgroundChoice",
    "FrameSaliency",
    "accumulate",
    "choose_background",
    "estimate_saliency",
    "flow_consistency",
    "flow_growth",
    "foreground_probability",
    "memory_weight",
    "motion_logit",
    "motion_odds",
    "moves_now",
    "own_motion_misfit",
    "probability",
    "remembered_logit",
    "share_out",
]
