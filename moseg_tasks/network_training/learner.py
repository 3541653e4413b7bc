"""The state of a training and its step."""

import copy
import math
from collections.abc import Callable

import torch
from torch import Tensor

from moseg.schemas.parameters import NetworkTrainingParams
from moseg.tasks.motion_network.unet import MotionUNet
from moseg.tasks.network_training.batch import Batch
from moseg.tasks.network_training.losses import label_loss


class Learner:
    """A network in training, the moving average of its weights, and the optimizer.

    Parameters
    ----------
    network : MotionUNet
    params : NetworkTrainingParams
    device : torch.device
    normalises : bool
        Whether the statistics of the normalisations are learned too; a network read from ONNX has none.
    """

    def __init__(
        self, network: MotionUNet, params: NetworkTrainingParams, device: torch.device, normalises: bool = True
    ):
        self.network = network.to(device, memory_format=torch.channels_last).train(normalises)
        self.average = copy.deepcopy(self.network).eval()
        self.step = 0
        self.device = device
        self._params = params
        self._normalises = normalises
        parameters = list(self.network.parameters())
        groups = [
            {"params": [each for each in parameters if each.ndim > 1], "weight_decay": params.decay},
            {"params": [each for each in parameters if each.ndim <= 1], "weight_decay": 0.0},
        ]
        self._optimizer = torch.optim.AdamW(groups, params.rate)

    def learn(self, loss_of: Callable[[], Tensor]) -> Tensor:
        """Take one step down the gradient of a loss, and return the loss; a GPU is not waited for."""
        for group in self._optimizer.param_groups:
            group["lr"] = learning_rate(self.step, self._params)
        self._optimizer.zero_grad()
        loss = loss_of()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), self._params.gradient)
        self._optimizer.step()
        self.step += 1
        self._follow()
        return loss.detach()

    def logits(self, channels: Tensor) -> Tensor:
        """Return the logits float32 (sample, y, x) of the network in training."""
        return apply_network(self.network, channels)

    def label_loss(self, batch: Batch) -> Tensor:
        """Return the loss of the network in training on a batch."""
        logit = self.logits(batch.channels)
        return label_loss(logit, batch.label, batch.weight, self._params.smoothing, self._params.overlap)

    def state(self) -> dict:
        """Return all that `load` needs, in tensors and plain values."""
        return {
            "network": self.network.state_dict(),
            "average": self.average.state_dict(),
            "optimizer": self._optimizer.state_dict(),
            "step": self.step,
        }

    def load(self, state: dict) -> None:
        """Go on from a state; raises KeyError, RuntimeError or ValueError if it is that of another network."""
        self.network.load_state_dict(state["network"])
        self.average.load_state_dict(state["average"])
        self._optimizer.load_state_dict(state["optimizer"])
        self.step = int(state["step"])

    @torch.no_grad()
    def _follow(self) -> None:
        """Move the average towards the network; faster in the first steps, so that it forgets the random start."""
        keep = min(self._params.average, (1 + self.step) / (10 + self.step))
        for mean, new in zip(self.average.state_dict().values(), self.network.state_dict().values(), strict=True):
            if mean.dtype.is_floating_point:
                mean.lerp_(new, 1 - keep)
            else:
                mean.copy_(new)


def apply_network(network: MotionUNet, channels: Tensor) -> Tensor:
    """Return the logits float32 (sample, y, x) of channels float32 (sample, channel, y, x).

    They are computed in bfloat16, except on processors without AVX-512, where it takes four times as long.
    """
    is_fast = channels.device.type != "cpu" or torch.backends.cpu.get_cpu_capability() == "AVX512"
    with torch.autocast(channels.device.type, torch.bfloat16, enabled=is_fast):
        logit = network(channels.contiguous(memory_format=torch.channels_last))
    return logit[:, 0].float()


def learning_rate(step: int, params: NetworkTrainingParams) -> float:
    """Return the rate of a step, counted from 0: a linear rise and half a cosine."""
    rise = min(1.0, (step + 1) / params.warm_up)
    fall = 0.5 * (1 + math.cos(math.pi * step / params.steps)) + params.last_rate
    return params.rate * rise * fall
