"""Depth Anything 3 as a module."""

import torch
from torch import Tensor, nn

from moseg.tasks.networks.depth.positions import PATCH
from moseg.tasks.networks.depth_anything_3.backbone import Backbone
from moseg.tasks.networks.depth_anything_3.config import DepthAnything3Config
from moseg.tasks.networks.depth_anything_3.head import DepthHead


class DepthAnything3(nn.Module):
    """Network of the depth of single images.

    It can also relate several views, and estimate their cameras and rays; these parts are left out.

    References
    ----------
    Lin et al., "Depth Anything 3: Recovering the Visual Space from Any Views", 2025.
    """

    def __init__(self, config: DepthAnything3Config):
        super().__init__()
        self.backbone = nn.ModuleDict({"pretrained": Backbone(config)})
        self.head = DepthHead(config)

    @property
    def device(self) -> torch.device:
        """Device of the weights."""
        return self.backbone["pretrained"].pos_embed.device

    def forward(self, pixels: Tensor) -> Tensor:
        """Estimate the depth of each image.

        Parameters
        ----------
        pixels : Tensor (B, 3, y, x)
            RGB, normalised by ImageNet's mean and standard deviation; both sides multiples of 14.

        Returns
        -------
        Tensor (B, y, x)
            Natural logarithm of the depth, which is known up to a factor of the image.
        """
        rows, columns = (side // PATCH for side in pixels.shape[2:])
        layers = self.backbone["pretrained"](pixels)
        # The authors, too, run the head in full precision.
        with torch.autocast(pixels.device.type, enabled=False):
            return self.head([tokens.to(self.head.norm.weight.dtype) for tokens in layers], rows, columns)[:, 0]
