"""The motion network: a small network of our own that tells what moves from the flow of a frame to its neighbours.

It is trained on rendered scenes alone (`moseg.tasks.training_scenes`). Inference needs OpenCV, training needs torch.
"""

from moseg.tasks.motion_network.carrying import carry_logits
from moseg.tasks.motion_network.encoding import CHANNELS, GRID_SIDE, Neighbour, encode_motion
from moseg.tasks.motion_network.evidence import join_evidence
from moseg.tasks.motion_network.inference import motion_network_logit, read_network

__all__ = [
    "CHANNELS",
    "GRID_SIDE",
    "Neighbour",
    "carry_logits",
    "encode_motion",
    "join_evidence",
    "motion_network_logit",
    "read_network",
]
