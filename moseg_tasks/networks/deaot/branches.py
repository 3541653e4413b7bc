"""The stack of gated propagation modules."""

from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import nn

from moseg.tasks.networks.deaot.attention import Window
from moseg.tasks.networks.deaot.config import DeaotConfig
from moseg.tasks.networks.deaot.propagation import GatedPropagationModule, LayerMemory, Projected


class Grid(NamedTuple):
    """The cells of a frame: the grid's size (y, x), and the window around each cell."""

    size: tuple[int, int]
    window: Window


class TokenGroupNorm(nn.Module):
    """Group normalisation of (batch, cell, channel): each branch over the whole frame."""

    def __init__(self, width: int, num_groups: int):
        super().__init__()
        self.gn = nn.GroupNorm(num_groups, width)

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        return self.gn(tokens.transpose(1, 2)).transpose(1, 2)


class DualBranchPropagation(nn.Module):
    """A sequence of modules, each with its own memory."""

    def __init__(self, config: DeaotConfig):
        super().__init__()
        self.layers = nn.ModuleList(
            GatedPropagationModule(config.d_model, config.window_radius, is_first=i == 0)
            for i in range(config.num_layers)
        )
        self.decoder_norms = nn.ModuleList([TokenGroupNorm(2 * config.d_model, num_groups=2)])

    def memorize(self, visual: torch.Tensor, assigned: torch.Tensor, grid: Grid) -> list[LayerMemory]:
        """Return each module's memory of a frame with given objects, which is propagated from itself."""
        memories, identity = [], None
        for layer in self.layers:
            frame = layer.project(visual, identity)
            memory = layer.remember(frame, assigned)
            visual, identity = layer(visual, identity, frame, memory, memory, *grid)
            memories.append(memory)
        return memories

    def forward(
        self, visual: torch.Tensor, long_term: Sequence[LayerMemory], short_term: Sequence[LayerMemory], grid: Grid
    ) -> tuple[torch.Tensor, list[Projected]]:
        """Return normalised, concatenated branches (batch, cell, 2 d_model) and the frame projected by each module."""
        frames, identity = [], None
        for layer, distant, near in zip(self.layers, long_term, short_term, strict=True):
            frame = layer.project(visual, identity)
            visual, identity = layer(visual, identity, frame, distant, near, *grid)
            frames.append(frame)
        return self.decoder_norms[-1](torch.cat([visual, identity], dim=-1)), frames

    def remember(self, frames: Sequence[Projected], assigned: torch.Tensor) -> list[LayerMemory]:
        """Return each module's memory of a propagated frame whose objects have been decided."""
        return [layer.remember(frame, assigned) for layer, frame in zip(self.layers, frames, strict=True)]
