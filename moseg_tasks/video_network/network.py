"""A small U-Net from the colours of a frame to the logit of each pixel to move."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import torch
from torch import nn
from torch.nn import functional

from moseg.tasks.video_network.crops import network_input

_CHANNELS = (24, 48, 96)
_STRIDE = 8


class VideoNetwork(nn.Module):
    """U-Net of three levels, the finest at half the resolution: four pixels are folded into the channels and back.

    It has 0.3 million parameters.
    """

    def __init__(self):
        super().__init__()
        fine, middle, coarse = _CHANNELS
        self.fine = nn.Sequential(_block(4 * 3, fine), _block(fine, fine))
        self.middle = nn.Sequential(_block(fine, middle, stride=2), _block(middle, middle))
        self.coarse = nn.Sequential(_block(middle, coarse, stride=2), _block(coarse, coarse), _block(coarse, coarse))
        self.to_middle = nn.Conv2d(coarse, middle, 1)
        self.join_middle = _block(2 * middle, middle)
        self.to_fine = nn.Conv2d(middle, fine, 1)
        self.join_fine = _block(2 * fine, fine)
        self.out = nn.Conv2d(fine, 4, 1)

    def forward(self, colours: torch.Tensor) -> torch.Tensor:
        """Return logits float32 (batch, y, x) of `colours` float32 (batch, 3, y, x)."""
        height, width = colours.shape[-2:]
        padded = functional.pad(colours, (0, -width % _STRIDE, 0, -height % _STRIDE), mode="replicate")
        fine = self.fine(functional.pixel_unshuffle(padded, 2))
        middle = self.middle(fine)
        below = self.to_middle(self.coarse(middle))
        below = self.join_middle(torch.cat([middle, _double(below)], dim=1))
        joined = self.join_fine(torch.cat([fine, _double(self.to_fine(below))], dim=1))
        return functional.pixel_shuffle(self.out(joined), 2)[:, 0, :height, :width]


def build_network(rng: np.random.Generator) -> VideoNetwork:
    """Build a network with random weights."""
    network = _new_network()
    seeded = torch.Generator().manual_seed(int(rng.integers(2**31)))
    for module in network.modules():
        if isinstance(module, nn.Conv2d):
            nn.init.kaiming_normal_(module.weight, nonlinearity="relu", generator=seeded)
            if module.bias is not None:
                nn.init.zeros_(module.bias)
    return network.to(memory_format=torch.channels_last)


def pack_weights(network: VideoNetwork) -> np.ndarray:
    """Return all weights of a network, the means and variances of its normalisation included, float32 (parameter,)."""
    return np.concatenate([tensor.detach().numpy().ravel() for tensor in _tensors(network)])


def restore_network(weights: np.ndarray) -> VideoNetwork:
    """Return the network of weights of `pack_weights`, for inference."""
    network, start = _new_network(), 0
    for tensor in _tensors(network):
        part = np.array(weights[start : start + tensor.numel()])
        tensor.data.copy_(torch.from_numpy(part).reshape(tensor.shape))
        start += tensor.numel()
    return network.to(memory_format=torch.channels_last).eval()


def infer_logits(network: VideoNetwork, lab: np.ndarray) -> np.ndarray:
    """Return the logits float32 (y, x) of one frame, uint8 (y, x, 3) of `lab_bytes`."""
    with torch.inference_mode(), reproducible():
        colours = torch.from_numpy(network_input(lab)).permute(2, 0, 1)[None]
        return network(colours.contiguous(memory_format=torch.channels_last))[0].numpy()


@contextmanager
def reproducible() -> Iterator[None]:
    """Run the block on one thread with deterministic algorithms, so that its result is the same in every process."""
    threads, was_deterministic = torch.get_num_threads(), torch.are_deterministic_algorithms_enabled()
    torch.set_num_threads(1)
    torch.use_deterministic_algorithms(True)
    try:
        yield
    finally:
        torch.use_deterministic_algorithms(was_deterministic)
        torch.set_num_threads(threads)


def _new_network() -> VideoNetwork:
    # Modules draw their first weights, which are not used, from the generator that the whole process shares.
    with torch.random.fork_rng(devices=[]):
        return VideoNetwork()


def _tensors(network: VideoNetwork) -> list[torch.Tensor]:
    return [tensor for tensor in network.state_dict().values() if tensor.is_floating_point()]


def _block(inputs: int, outputs: int, stride: int = 1) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU(inplace=True)
    )


def _double(features: torch.Tensor) -> torch.Tensor:
    return functional.interpolate(features, scale_factor=2, mode="nearest")
