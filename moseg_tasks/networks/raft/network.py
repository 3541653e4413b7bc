"""RAFT as a module: its attributes are named as in torchvision's state dicts."""

import torch
from torch import Tensor, nn

from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly
from moseg.tasks.networks.raft.config import LARGE, SMALL, RaftConfig
from moseg.tasks.networks.raft.correlation import CorrelationPyramid
from moseg.tasks.networks.raft.encoder import Encoder
from moseg.tasks.networks.raft.layouts import to_own_names
from moseg.tasks.networks.raft.update import UpdateBlock
from moseg.tasks.networks.raft.upsampling import STRIDE, MaskPredictor, upsample_bilinear, upsample_convex


class Raft(nn.Module):
    """Network that estimates flow by iterated look-ups in the correlation of all pairs of cells.

    References
    ----------
    Teed, Deng, "RAFT: Recurrent All-Pairs Field Transforms for Optical Flow", ECCV 2020.
    """

    def __init__(self, config: RaftConfig):
        super().__init__()
        self.config = config
        context_channels = config.hidden_channels + config.context_channels
        context_norm = nn.BatchNorm2d if config.has_context_norm else None
        self.feature_encoder = Encoder(
            config.block, config.stage_channels, config.feature_channels, norm=nn.InstanceNorm2d
        )
        self.context_encoder = Encoder(config.block, config.stage_channels, context_channels, norm=context_norm)
        self.update_block = UpdateBlock(config)
        self.mask_predictor = (
            None if config.mask_channels is None else MaskPredictor(config.hidden_channels, config.mask_channels)
        )

    @property
    def min_side(self) -> int:
        """Minimal side that leaves the coarsest level of the correlation pyramid two cells, px; 128 as published.

        With a single cell the published code divides by zero, so no published network was applied to smaller images.
        """
        return STRIDE * 2**self.config.correlation_levels

    def forward(self, images0: Tensor, images1: Tensor, iterations: int, on_demand: bool = False) -> Tensor:
        """Estimate the flow from the first images to the second.

        Parameters
        ----------
        images0, images1 : Tensor (B, 3, y, x)
            RGB in [-1, 1]; both sides multiples of 8 and not below `min_side`.
        iterations : int
            Steps of the flow.
        on_demand : bool
            Compute correlations at each look-up instead of storing them all.

        Returns
        -------
        Tensor (B, 2, y, x)
            xy, px; float32, or float64 with a network in float64.
        """
        config = self.config
        features0, features1 = self.feature_encoder(torch.cat([images0, images1])).chunk(2)
        correlation = CorrelationPyramid(
            features0, features1, config.correlation_levels, config.correlation_radius, on_demand
        )
        state = self.context_encoder(images0)
        hidden, context = state.split([config.hidden_channels, config.context_channels], dim=1)
        hidden, context = hidden.tanh(), context.relu()

        # The flow is summed over the iterations and added to coordinates: half precision would round it to 1/16 cell.
        dtype = torch.promote_types(features0.dtype, torch.float32)
        cells = cell_grid(features0).to(dtype)
        flow = torch.zeros_like(cells).repeat(len(images0), 1, 1, 1)
        for _ in range(iterations):
            hidden, step = self.update_block(hidden, context, correlation.look_up(cells + flow), flow)
            flow = flow + step.to(dtype)
        if self.mask_predictor is None:
            return upsample_bilinear(flow)
        return upsample_convex(flow, self.mask_predictor(hidden))


def cell_grid(features: Tensor) -> Tensor:
    """Return each cell's xy, (1, 2, h, w)."""
    y, x = (torch.arange(side, device=features.device) for side in features.shape[2:])
    return torch.stack(torch.meshgrid(x, y, indexing="xy"))[None]


def build_raft(checkpoint: Checkpoint) -> Raft:
    """Build RAFT with a checkpoint's tensors, in evaluation mode, float32 and without gradients.

    Parameters
    ----------
    checkpoint : Checkpoint
        Tensors in torchvision's or princeton's layout. They are of the large network if they have an upsampling head,
        of the small one otherwise; `config` holds fields of `RaftConfig` that differ from its sizes.

    Raises
    ------
    InputError
        A tensor is missing, left over or of another shape; or `config` has other fields than `RaftConfig`.
    """
    tensors = to_own_names(checkpoint.tensors, checkpoint.name)
    published = LARGE if any(key.startswith("mask_predictor.") for key in tensors) else SMALL
    return load_strictly(Raft(checkpoint.sizes(published)).float(), tensors, checkpoint.name)
