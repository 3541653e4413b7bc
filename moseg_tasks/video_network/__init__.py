"""A small network trained on one video, with labels that its motion makes sure.

`network` and `training` need torch and are imported by name; the rest does not.
"""

from moseg.tasks.video_network.evidence import Outcome, measure_outcome, network_weight, refine_foreground
from moseg.tasks.video_network.labels import IGNORED, MOVING, STATIC, sure_labels

__all__ = [
    "IGNORED",
    "MOVING",
    "STATIC",
    "Outcome",
    "measure_outcome",
    "network_weight",
    "refine_foreground",
    "sure_labels",
]
