"""The DeAOT network."""

from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import nn

from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly
from moseg.tasks.networks.deaot.attention import at_least_float32, neighbourhood
from moseg.tasks.networks.deaot.branches import DualBranchPropagation, Grid
from moseg.tasks.networks.deaot.config import DeaotConfig
from moseg.tasks.networks.deaot.decoder import FpnDecoder
from moseg.tasks.networks.deaot.encoder import EXPANSION, Pyramid, ResNetEncoder
from moseg.tasks.networks.deaot.propagation import LayerMemory, Projected

STRIDE = 16
"""Side of a cell, px; a frame's sides are 1 modulo this, so that corner cells lie on corner pixels."""


class Encoded(NamedTuple):
    """A frame's pyramid, and its cells (1, cell, d_model), the input of propagation."""

    pyramid: Pyramid
    cells: torch.Tensor


class Deaot(nn.Module):
    """Semi-supervised video object segmentation by propagation of masks from frames in memory.

    The batch dimension of memories, masks and logits are groups of at most `max_objects` objects, tracked in parallel;
    a frame is encoded once for all groups.

    References
    ----------
    Yang and Yang, "Decoupling Features in Hierarchical Propagation for Video Object Segmentation", NeurIPS 2022.
    """

    def __init__(self, config: DeaotConfig):
        super().__init__()
        self.config = config
        self.encoder = ResNetEncoder(config)
        self.encoder_projector = nn.Conv2d(EXPANSION * config.stage_widths[-1], config.d_model, 1)
        self.LSTT = DualBranchPropagation(config)
        self.decoder = FpnDecoder(config)
        self.patch_wise_id_bank = nn.Conv2d(
            1 + config.max_objects, config.d_model, STRIDE + 1, stride=STRIDE, padding=STRIDE // 2
        )
        self.id_norm = nn.LayerNorm(config.d_model)

    def grid(self, size: tuple[int, int]) -> Grid:
        """Return the cells of frames of `size` (y, x); the same for all frames of a video."""
        height, width = ((side - 1) // STRIDE + 1 for side in size)
        return Grid(
            (height, width), neighbourhood((height, width), self.config.window_radius, self.id_norm.weight.device)
        )

    def encode(self, image: torch.Tensor) -> Encoded:
        """Encode a normalised RGB frame (1, 3, y, x) with sides of 1 modulo 16."""
        pyramid = self.encoder(image)
        return Encoded(pyramid, self.encoder_projector(pyramid.stride16).flatten(2).transpose(1, 2))

    def assign(self, masks: torch.Tensor) -> torch.Tensor:
        """Embed masks (group, 1 + max_objects, y, x) that are 1 in their object as (group, cell, d_model)."""
        return self.id_norm(self.patch_wise_id_bank(masks).flatten(2).transpose(1, 2))

    def memorize(self, frame: Encoded, masks: torch.Tensor, grid: Grid) -> list[LayerMemory]:
        """Return the memory of a frame whose masks are given."""
        return self.LSTT.memorize(frame.cells.expand(len(masks), -1, -1), self.assign(masks), grid)

    def propagate(
        self, frame: Encoded, long_term: Sequence[LayerMemory], short_term: Sequence[LayerMemory], grid: Grid
    ) -> tuple[torch.Tensor, list[Projected]]:
        """Return logits (group, 1 + max_objects, y / 4, x / 4) of a frame, and its projections for `remember`."""
        num_groups = len(short_term[0].keys)
        cells, frames = self.LSTT(frame.cells.expand(num_groups, -1, -1), long_term, short_term, grid)
        logits = self.decoder(cells.transpose(1, 2).unflatten(2, grid.size), frame.pyramid)
        return at_least_float32(logits), frames

    def remember(self, frames: Sequence[Projected], masks: torch.Tensor) -> list[LayerMemory]:
        """Return the memory of a propagated frame whose masks have been decided."""
        return self.LSTT.remember(frames, self.assign(masks))


def build_deaot(checkpoint: Checkpoint) -> Deaot:
    """Build DeAOT with the checkpoint's tensors: the published R50-DeAOTL, or of the sizes in `checkpoint.config`.

    Parameters
    ----------
    checkpoint : Checkpoint
        `config` holds fields of `DeaotConfig` that differ from the published ones.

    Returns
    -------
    Deaot
        On the CPU, float32, in evaluation mode, without gradients.

    Raises
    ------
    InputError
        The config has a field or value that DeAOT cannot have, or a tensor is missing, left over or of another shape.
    """
    return load_strictly(Deaot(checkpoint.sizes(DeaotConfig())), checkpoint.tensors, checkpoint.name)
