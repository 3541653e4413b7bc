"""Upsampling of flow from an eighth of the resolution to every pixel."""

import torch.nn.functional as F
from torch import Tensor, nn

from moseg.tasks.networks.raft.convolution import conv_norm_relu

STRIDE = 8
"""Pixels along a cell's side, because the encoders halve the resolution three times."""
_NEIGHBOURS = 9
# The published weights were trained with this factor before the softmax, to weaken the branch's gradients.
_LOGIT_SCALE = 0.25


class MaskPredictor(nn.Module):
    """Logits of each pixel's weights over the 3x3 cells around its own, from the recurrent state."""

    def __init__(self, hidden_channels: int, mask_channels: int):
        super().__init__()
        self.convrelu = conv_norm_relu(hidden_channels, mask_channels, 3)
        self.conv = nn.Conv2d(mask_channels, _NEIGHBOURS * STRIDE**2, 1)

    def forward(self, hidden: Tensor) -> Tensor:
        """Map the state (B, channels, h, w) to logits (B, 9 * 8 * 8, h, w)."""
        return _LOGIT_SCALE * self.conv(self.convrelu(hidden))


def upsample_convex(flow: Tensor, logits: Tensor) -> Tensor:
    """Upsample flow: each pixel's is a convex combination of the flow of the nine cells around it.

    Parameters
    ----------
    flow : Tensor (B, 2, h, w)
        Cells.
    logits : Tensor (B, 9 * 8 * 8, h, w)
        By neighbour, row and column within the cell. Outside the grid the flow counts as zero.

    Returns
    -------
    Tensor (B, 2, 8 h, 8 w)
        Pixels, in the flow's precision.

    References
    ----------
    Teed, Deng, ECCV 2020, section 3.3 and appendix B.
    """
    size = flow.shape[2:]
    weights = logits.to(flow.dtype).unflatten(1, (1, _NEIGHBOURS, STRIDE**2)).softmax(dim=2)
    neighbours = F.unfold(STRIDE * flow, 3, padding=1).unflatten(2, size).unflatten(1, (2, _NEIGHBOURS, 1))
    return F.pixel_shuffle((weights * neighbours).sum(dim=2).flatten(1, 2), STRIDE)


def upsample_bilinear(flow: Tensor) -> Tensor:
    """Upsample flow (B, 2, h, w) in cells to (B, 2, 8 h, 8 w) in pixels, with aligned corners as in training."""
    return STRIDE * F.interpolate(flow, scale_factor=STRIDE, mode="bilinear", align_corners=True)
