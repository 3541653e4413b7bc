"""Training of a network on the sure labels of a stretch of video."""

import numpy as np
import torch
from torch import nn
from torch.nn import functional

from moseg.schemas.parameters import VideoNetworkParams
from moseg.tasks.video_network.crops import draw_crop
from moseg.tasks.video_network.labels import MOVING, STATIC
from moseg.tasks.video_network.network import VideoNetwork, build_network, reproducible

_WEIGHT_DECAY = 1e-2
_MAX_GRADIENT = 1.0


def train_network(
    lab: np.ndarray, labels: np.ndarray, rng: np.random.Generator, params: VideoNetworkParams
) -> VideoNetwork:
    """Train a network from a random start to tell what moves from what is static by its look.

    Classes are weighted by the inverse square root of their share: a small object counts, yet does not spread.

    Parameters
    ----------
    lab : uint8 (T, y, x, 3)
        Frames, of `lab_bytes`.
    labels : uint8 (T, y, x)
        Of `sure_labels`; both `MOVING` and `STATIC` occur.
    rng : numpy.random.Generator
        Of the start and of all crops.
    params : VideoNetworkParams

    Returns
    -------
    VideoNetwork
        For inference.
    """
    with reproducible():
        network = build_network(rng).train()
        optimiser = torch.optim.AdamW(network.parameters(), lr=params.learning_rate, weight_decay=_WEIGHT_DECAY)
        # A cycle has at least one step on either side of its peak.
        total = max(params.steps, 3)
        schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, params.learning_rate, total_steps=total)
        class_weights = torch.from_numpy(_class_weights(labels))
        for _ in range(params.steps):
            crops = [draw_crop(lab, labels, rng, params) for _ in range(params.crops)]
            colours = torch.from_numpy(np.stack([crop.colours for crop in crops])).permute(0, 3, 1, 2)
            truth = torch.from_numpy(np.stack([crop.labels for crop in crops]))
            loss = _loss(network(colours), truth, class_weights)
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(network.parameters(), _MAX_GRADIENT)
            optimiser.step()
            schedule.step()
        return network.eval()


def _class_weights(labels: np.ndarray) -> np.ndarray:
    """Return the weight float32 of a pixel by its label, 0 for those that are ignored."""
    counts = np.array([(labels == label).sum() for label in (STATIC, MOVING)], np.float64)
    weights = (counts / counts.sum()) ** -0.5
    return np.array([*weights, 0], np.float32)


def _loss(logits: torch.Tensor, truth: torch.Tensor, class_weights: torch.Tensor) -> torch.Tensor:
    """Return the weighted mean of the cross entropy over the pixels that are not ignored."""
    weights = class_weights[truth.long()]
    errors = functional.binary_cross_entropy_with_logits(logits, (truth == MOVING).float(), reduction="none")
    return (errors * weights).sum() / weights.sum().clamp(min=1)
