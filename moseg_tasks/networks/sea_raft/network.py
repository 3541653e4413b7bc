"""SEA-RAFT as a module."""

import torch
from torch import Tensor, nn

from moseg.tasks.networks.checkpoint import Checkpoint, load_strictly
from moseg.tasks.networks.raft.correlation import CorrelationPyramid
from moseg.tasks.networks.raft.encoder import Encoder
from moseg.tasks.networks.raft.network import cell_grid
from moseg.tasks.networks.raft.upsampling import STRIDE, MaskPredictor, upsample_convex
from moseg.tasks.networks.sea_raft.config import MEDIUM, SMALL, SeaRaftConfig
from moseg.tasks.networks.sea_raft.layout import to_own_names
from moseg.tasks.networks.sea_raft.refinement import UpdateBlock

_HEAD_CHANNELS = 6
"""Of a cell: its flow, and the weights and scales of the mixture of two Laplace distributions, which we do not use."""
_DEEPER_BLOCK = "feature_encoder.layer1.2."
"""Prefix of tensors that ResNet-34 has and ResNet-18 has not."""


class SeaRaft(nn.Module):
    """Network that regresses a first flow from both images, and refines it by look-ups in the correlations.

    References
    ----------
    Wang, Lipson, Deng, "SEA-RAFT: Simple, Efficient, Accurate RAFT for Optical Flow", ECCV 2024.
    """

    def __init__(self, config: SeaRaftConfig):
        super().__init__()
        self.config = config
        hidden, stages, blocks = config.hidden_channels, config.stage_channels, config.num_blocks
        # Both encoders are the residual network's; the context is of both images.
        self.feature_encoder = Encoder("residual", stages, 2 * hidden, nn.BatchNorm2d, 3, blocks)
        self.context_encoder = Encoder("residual", stages, 2 * hidden, nn.BatchNorm2d, 6, blocks)
        self.init_conv = nn.Conv2d(2 * hidden, 2 * hidden, 3, padding=1)
        self.update_block = UpdateBlock(config)
        self.flow_head = nn.Sequential(
            nn.Conv2d(hidden, 2 * hidden, 3, padding=1),
            nn.ReLU(inplace=True),
            nn.Conv2d(2 * hidden, _HEAD_CHANNELS, 3, padding=1),
        )
        self.mask_predictor = MaskPredictor(hidden, 2 * hidden)

    @property
    def min_side(self) -> int:
        """Minimal side that leaves the coarsest level of the correlation pyramid two cells, px; 128 as published."""
        return STRIDE * 2**self.config.correlation_levels

    def forward(self, images0: Tensor, images1: Tensor, iterations: int, on_demand: bool = False) -> Tensor:
        """Estimate the flow from the first images to the second.

        Parameters
        ----------
        images0, images1 : Tensor (B, 3, y, x)
            RGB in [-1, 1]; both sides multiples of 8 and not below `min_side`.
        iterations : int
            Steps of the flow after the first estimate.
        on_demand : bool
            Compute correlations at each look-up instead of storing them all.

        Returns
        -------
        Tensor (B, 2, y, x)
            xy, px; float32, or float64 with a network in float64.
        """
        config = self.config
        hidden, context = self.init_conv(self.context_encoder(torch.cat([images0, images1], dim=1))).chunk(2, dim=1)
        features0, features1 = self.feature_encoder(torch.cat([images0, images1])).chunk(2)
        correlation = CorrelationPyramid(
            features0, features1, config.correlation_levels, config.correlation_radius, on_demand
        )
        # As in RAFT: half precision would round the sum of the steps to 1/16 cell.
        dtype = torch.promote_types(features0.dtype, torch.float32)
        cells = cell_grid(features0).to(dtype)
        flow = self._step(hidden, dtype)
        for _ in range(iterations):
            hidden = self.update_block(hidden, context, correlation.look_up(cells + flow), flow)
            flow = flow + self._step(hidden, dtype)
        return upsample_convex(flow, self.mask_predictor(hidden))

    def _step(self, hidden: Tensor, dtype: torch.dtype) -> Tensor:
        """Return the update of the flow, (B, 2, h, w) in cells."""
        return self.flow_head(hidden)[:, :2].to(dtype)


def build_sea_raft(checkpoint: Checkpoint) -> SeaRaft:
    """Build SEA-RAFT with a checkpoint's tensors, in evaluation mode, float32 and without gradients.

    Parameters
    ----------
    checkpoint : Checkpoint
        Tensors in the published layout, on ResNet-34 or ResNet-18, which their names distinguish; `config` holds
        fields of `SeaRaftConfig` that differ from the published sizes.

    Raises
    ------
    InputError
        A tensor is missing, left over or of another shape; or `config` has other fields than `SeaRaftConfig`.
    """
    tensors = to_own_names(checkpoint.tensors, checkpoint.name)
    published = MEDIUM if any(key.startswith(_DEEPER_BLOCK) for key in tensors) else SMALL
    return load_strictly(SeaRaft(checkpoint.sizes(published)).float(), tensors, checkpoint.name)
