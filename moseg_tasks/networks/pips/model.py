"""The PIPs network: positions of points of a window's first frame in its other frames."""

from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import nn

from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly
from moseg.tasks.networks.pips.config import PipsConfig
from moseg.tasks.networks.pips.correlation import correlate, feature_pyramid, sample_appearances
from moseg.tasks.networks.pips.encoder import Encoder
from moseg.tasks.networks.pips.mixer import Update


class Trajectories(NamedTuple):
    """Estimates of the network for N points in the S frames of a window.

    Attributes
    ----------
    points : torch.Tensor (N, S, 2)
        xy, px of the images; in the first frame the points given.
    visibility : torch.Tensor (N, S)
        Logits.
    """

    points: torch.Tensor
    visibility: torch.Tensor


class Pips(nn.Module):
    """Persistent independent particles: each point is tracked independently, also through occlusions within a window.

    Attribute names are those of the published state dict.

    References
    ----------
    A. Harley, Z. Fang and K. Fragkiadaki, Particle video revisited: tracking through occlusions using point
    trajectories, ECCV 2022.
    """

    def __init__(self, config: PipsConfig):
        super().__init__()
        self.config = config
        self.fnet = Encoder(config)
        self.delta_block = Update(config)
        self.norm = nn.GroupNorm(1, config.latent)
        self.ffeat_updater = nn.Sequential(nn.Linear(config.latent, config.latent), nn.GELU())
        self.vis_predictor = nn.Sequential(nn.Linear(config.latent, 1))

    def encode(self, images: torch.Tensor) -> tuple[torch.Tensor, ...]:
        """Return the feature pyramid of frames; each is encoded independently, so windows can share frames.

        Parameters
        ----------
        images : torch.Tensor (B, y, x, 3)
            RGB in [0, 255]; sides of at least `config.min_side`.

        Returns
        -------
        pyramid : tuple of torch.Tensor (B, y // stride, x // stride, C)
            Finest level first; each next one has half the size.
        """
        dtype = self.dtype
        maps = self.fnet(2 * (images.permute(0, 3, 1, 2).to(dtype) / 255) - 1)
        return feature_pyramid(maps.to(dtype), self.config.levels)

    def appearances(self, pyramid: Sequence[torch.Tensor], points: torch.Tensor) -> torch.Tensor:
        """Return the appearance (N, C) of points (N, 2), px, in the first frame of a pyramid."""
        return sample_appearances(pyramid[0][0], points / self.config.stride)

    def forward(
        self, pyramid: Sequence[torch.Tensor], points: torch.Tensor, appearances: torch.Tensor, iterations: int
    ) -> Trajectories:
        """Follow points through a window.

        Parameters
        ----------
        pyramid : sequence of torch.Tensor (S, y, x, C)
            Of `encode`, for the S frames of the window.
        points : torch.Tensor (N, 2)
            xy in the first frame, px.
        appearances : torch.Tensor (N, C)
            Appearance to search for: of `appearances` in the first frame, or in the first frame that showed a point.
        iterations : int
            Steps of refinement, from points at rest and appearances that do not change.

        Returns
        -------
        Trajectories
        """
        shape = (len(points), self.config.window, -1)
        start = (points / self.config.stride)[:, None]
        positions = start.expand(shape)
        appearances = appearances[:, None].expand(shape)
        for _ in range(iterations):
            correlations = correlate(pyramid, appearances, positions, self.config.radius)
            shift, change = self.delta_block(appearances, correlations, positions - start)
            change = self.ffeat_updater(self.norm(change.flatten(0, 1))).view(shape)
            # Summed in full precision, whatever the precision of the layers.
            appearances = appearances + change.to(appearances.dtype)
            positions = torch.cat([start, (positions + shift)[:, 1:]], dim=1)
        visibility = self.vis_predictor(appearances).squeeze(-1)
        return Trajectories(positions * self.config.stride, visibility.to(points.dtype))

    @property
    def dtype(self) -> torch.dtype:
        """Type of the network's parameters, and so of its maps and points, autocast or not."""
        return self.vis_predictor[0].weight.dtype


def build_pips(checkpoint: Checkpoint) -> Pips:
    """Build the network of a checkpoint.

    Parameters
    ----------
    checkpoint : Checkpoint
        Tensors of the published ``model-000200000.pth``, or of a network with the sizes in `config` (`PipsConfig`).

    Returns
    -------
    Pips
        float32, on the CPU, in evaluation mode and without gradients.

    Raises
    ------
    InputError
        `config` has other fields than `PipsConfig`, or a tensor is missing, left over or of another shape.
    """
    # On the meta device, because initial values would only be overwritten.
    with torch.device("meta"):
        network = Pips(checkpoint.sizes(PipsConfig()))
    return load_strictly(network.to_empty(device="cpu"), checkpoint.tensors, checkpoint.name)
