"""The BootsTAPIR network: positions of points of any frame in all frames of a section."""

from collections.abc import Sequence
from math import ceil, log2
from typing import NamedTuple

import torch
import torch.nn.functional as F
from torch import nn

from moseg.tasks.networks.bootstapir.config import BootsTapirConfig
from moseg.tasks.networks.bootstapir.encoder import ExtraConvolutions, ResNet
from moseg.tasks.networks.bootstapir.matching import Matching
from moseg.tasks.networks.bootstapir.mixer import Mixer
from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly
from moseg.tasks.networks.pips.correlation import correlate_square, sample_appearances

MULTIPLE = 8
"""Sides of images are multiples of this, px: the coarse map has a cell for each."""


class FeatureGrid(NamedTuple):
    """Maps of S frames at one of the sizes at which they are encoded.

    Attributes
    ----------
    side : int
        Of the square images, px.
    levels : tuple of torch.Tensor (S, y, x, C)
        The fine map, the coarse map and its halvings.
    """

    side: int
    levels: tuple[torch.Tensor, ...]


class Trajectories(NamedTuple):
    """Estimates of the network for N points in S frames.

    Attributes
    ----------
    points : torch.Tensor (N, S, 2)
        xy, px of the images.
    occlusion : torch.Tensor (N, S)
        Logits of being hidden.
    uncertainty : torch.Tensor (N, S)
        Logits of being far from the estimated position.
    """

    points: torch.Tensor
    occlusion: torch.Tensor
    uncertainty: torch.Tensor


class BootsTapir(nn.Module):
    """Tracking any point: matching in each frame, then refinement over all of them, each point for itself.

    Attribute names are those of the published state dict.

    References
    ----------
    C. Doersch et al., TAPIR: Tracking any point with per-frame initialization and temporal refinement, ICCV 2023;
    C. Doersch et al., BootsTAP: Bootstrapped training for tracking-any-point, ACCV 2024.
    """

    def __init__(self, config: BootsTapirConfig):
        super().__init__()
        self.config = config
        self.resnet_torch = ResNet(config)
        self.torch_cost_volume_track_mods = Matching()
        self.torch_pips_mixer = Mixer(config)
        self.extra_convs = ExtraConvolutions(config)

    def encode(self, images: torch.Tensor) -> tuple[FeatureGrid, ...]:
        """Return the maps of frames at each size; each frame is encoded independently.

        Parameters
        ----------
        images : torch.Tensor (B, side, side, 3)
            RGB in [0, 255]; the side is a multiple of 8, and at least `config.matching_side`.

        Returns
        -------
        grids : tuple of FeatureGrid
            From `config.matching_side` to the images' side, in steps of at most a factor of two.
        """
        pixels = 2 * (images.permute(0, 3, 1, 2).to(self.dtype) / 255) - 1
        sides = refined_sides(self.config.matching_side, pixels.shape[-1])
        return tuple(self._encode_at(side, pixels) for side in sides)

    def _encode_at(self, side: int, pixels: torch.Tensor) -> FeatureGrid:
        if side != pixels.shape[-1]:
            pixels = F.interpolate(pixels, (side, side), mode="bilinear")
        fine, coarse = self.resnet_torch(pixels)
        fine, coarse = (_unit_length(maps.to(self.dtype)) for maps in (fine, self.extra_convs(coarse)))
        levels = [fine, coarse]
        for _ in range(self.config.pooled_levels):
            levels.append(F.avg_pool2d(levels[-1], 2))
        return FeatureGrid(side, tuple(level.permute(0, 2, 3, 1).contiguous() for level in levels))

    def appearances(self, grids: Sequence[FeatureGrid], frame: int, points: torch.Tensor) -> tuple[torch.Tensor, ...]:
        """Return the appearances (N, fine + coarse channels) of points (N, 2) in a frame, at each size.

        Points are px of the images, of the last grid's side.
        """
        shares = (points + 0.5) / grids[-1].side
        return tuple(
            torch.cat([sample_appearances(maps[frame], _cells(shares, maps)) for maps in grid.levels[:2]], dim=1)
            for grid in grids
        )

    def forward(
        self,
        grids: Sequence[FeatureGrid],
        points: torch.Tensor,
        frame: int,
        appearances: Sequence[torch.Tensor],
        iterations: int,
    ) -> Trajectories:
        """Follow points of one frame through all frames, forwards and backwards.

        Parameters
        ----------
        grids : sequence of FeatureGrid
            Of `encode`, for all frames.
        points : torch.Tensor (N, 2)
            xy in the frame `frame`, px.
        appearances : sequence of torch.Tensor (N, C)
            Of `appearances`, at each size.
        iterations : int
            Steps of refinement at each size.

        Returns
        -------
        Trajectories
            The mean of the estimates at all sizes.
        """
        coarse = appearances[0][:, self.config.fine :]
        positions, occlusion, uncertainty = self.torch_cost_volume_track_mods(coarse, grids[0].levels[1])
        positions[:, frame] = (points + 0.5) / grids[-1].side
        found = []
        for grid, appearance in zip(grids, appearances, strict=True):
            # As published, each size begins with the positions of the one before and the logits of the matching.
            state = positions, occlusion, uncertainty, appearance[:, None].expand(-1, positions.shape[1], -1)
            for _ in range(iterations):
                state = self._refine(grid, *state)
            positions = state[0]
            found.append(state[:3])
        positions, occlusion, uncertainty = (torch.stack(values).mean(dim=0) for values in zip(*found, strict=True))
        return Trajectories(positions * grids[-1].side - 0.5, occlusion, uncertainty)

    def _refine(self, grid: FeatureGrid, positions, occlusion, uncertainty, appearances):
        """Return the four (N, S, …) after one step."""
        config = self.config
        parts = appearances.split([config.fine, config.coarse], dim=2)
        squares = []
        # Half precision keeps three digits of a sum over all channels: too few to locate the peak of a correlation.
        with torch.autocast(positions.device.type, enabled=False):
            for index, maps in enumerate(grid.levels):
                square = correlate_square(maps, parts[min(index, 1)], _cells(positions, maps), config.radius)
                squares.append(square.transpose(2, 3).flatten(2))
        logits = torch.stack([occlusion, uncertainty], dim=2)
        # As published, the mixer sees no positions: zeros are in their place.
        inputs = torch.cat([torch.zeros_like(positions), logits, appearances, *squares], dim=2)
        # Summed in full precision, whatever the precision of the layers.
        change = self.torch_pips_mixer(inputs).to(self.dtype)
        positions = positions + change[..., :2] / grid.side
        return positions, occlusion + change[..., 2], uncertainty + change[..., 3], appearances + change[..., 4:]

    @property
    def dtype(self) -> torch.dtype:
        """Type of the network's parameters, and so of its maps and points, autocast or not."""
        return self.torch_pips_mixer.linear.weight.dtype


def refined_sides(first: int, last: int) -> tuple[int, ...]:
    """Return the sides at which points are refined, from `first` to `last` px in even factors of at most two.

    As published, the sides between are rounded down to multiples of 8.
    """
    if last <= first:
        return (first,)
    num_steps = ceil(log2(last / first))
    ratios = ((last / first) ** (index / num_steps) for index in range(num_steps))
    return (*(round(first * ratio // MULTIPLE) * MULTIPLE for ratio in ratios), last)


def _unit_length(maps: torch.Tensor) -> torch.Tensor:
    return maps / maps.square().sum(dim=1, keepdim=True).clamp(min=1e-12).sqrt()


def _cells(shares: torch.Tensor, maps: torch.Tensor) -> torch.Tensor:
    """Convert positions as a share of the frame to cells of maps (S, y, x, C), whose centres are integers."""
    height, width = maps.shape[1:3]
    return shares * shares.new_tensor([width, height]) - 0.5


def build_bootstapir(checkpoint: Checkpoint) -> BootsTapir:
    """Build the network of a checkpoint.

    Parameters
    ----------
    checkpoint : Checkpoint
        Tensors of the published ``bootstapir_checkpoint_v2.pt``, or of a network with the sizes in `config`
        (`BootsTapirConfig`).

    Returns
    -------
    BootsTapir
        float32, on the CPU, in evaluation mode and without gradients.

    Raises
    ------
    InputError
        `config` has other fields than `BootsTapirConfig`, or a tensor is missing, left over or of another shape.
    """
    # On the meta device, because initial values would only be overwritten.
    with torch.device("meta"):
        network = BootsTapir(checkpoint.sizes(BootsTapirConfig()))
    return load_strictly(network.to_empty(device="cpu"), checkpoint.tensors, checkpoint.name)
