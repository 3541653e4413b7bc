"""DINOv2's patches, and its position embeddings resampled to the size of a frame as in its training."""

from types import MethodType

import torch
from torch.nn import functional
from transformers import PreTrainedModel

PATCH = 14
"""Side of a patch of every DINOv2, px."""
OFFSET = 0.1
"""Cells added to the grid: by it DINOv2's authors kept the rounding of a scale from losing a cell."""


def resample_as_trained(model: PreTrainedModel) -> PreTrainedModel:
    """Make the model's backbone resample positions by the authors' factor, and return the model.

    transformers resamples them to a number of cells, which shifts the last ones by a tenth of a cell. On the published
    grid of 37 x 37 cells both are equal.
    """
    embeddings = model.backbone.embeddings
    embeddings.interpolate_pos_encoding = MethodType(_resample, embeddings)
    return model


def _resample(self, embeddings: torch.Tensor, height: int, width: int) -> torch.Tensor:
    """Return position embeddings (1, 1 + cells, channels) of a frame of `height` and `width` px."""
    return resample_positions(self.position_embeddings, height // self.patch_size, width // self.patch_size)


def resample_positions(positions: torch.Tensor, rows: int, columns: int) -> torch.Tensor:
    """Resample learned positions (1, 1 + side², channels) to (1, 1 + rows columns, channels); the first is kept."""
    side = round((positions.shape[1] - 1) ** 0.5)
    if (rows, columns) == (side, side):
        return positions
    grid = positions[:, 1:].unflatten(1, (side, side)).permute(0, 3, 1, 2)
    factors = tuple((number + OFFSET) / side for number in (rows, columns))
    grid = functional.interpolate(grid.float(), scale_factor=factors, mode="bicubic").to(grid.dtype)
    return torch.cat([positions[:, :1], grid.flatten(2).transpose(1, 2)], dim=1)
