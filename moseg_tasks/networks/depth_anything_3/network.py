"""Depth Anything 3 as modules: for single images, and for several views of one scene."""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from moseg.tasks.networks.depth.positions import PATCH
from moseg.tasks.networks.depth_anything_3.backbone import Backbone
from moseg.tasks.networks.depth_anything_3.camera_decoder import CameraDecoder
from moseg.tasks.networks.depth_anything_3.config import DepthAnything3Config
from moseg.tasks.networks.depth_anything_3.head import Dense, DepthHead


class DepthAnything3(nn.Module):
    """Network of the depth of single images.

    `DepthAnything3Views` also relates several views, and estimates their cameras or rays.

    References
    ----------
    Lin et al., "Depth Anything 3: Recovering the Visual Space from Any Views", 2025.
    """

    def __init__(self, config: DepthAnything3Config, has_rays: bool = False):
        super().__init__()
        self.backbone = nn.ModuleDict({"pretrained": Backbone(config)})
        self.head = DepthHead(config, has_rays)

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
        layers = self.backbone["pretrained"](pixels).cells
        # The authors, too, run the head in full precision.
        with torch.autocast(pixels.device.type, enabled=False):
            return self._dense(layers, pixels).depth[:, 0]

    def _dense(self, layers: list[Tensor], pixels: Tensor) -> Dense:
        rows, columns = (side // PATCH for side in pixels.shape[2:])
        return self.head([tokens.to(self.head.norm.weight.dtype) for tokens in layers], rows, columns)


class Views(NamedTuple):
    """Depth and cameras of S views of one scene, all in one unknown unit of length.

    Attributes
    ----------
    depth : Tensor (S, y, x)
        Natural logarithm of the depth.
    cameras : Tensor (S, 9)
        Of the decoder of cameras: centre; rotation from the camera to the scene as a quaternion, real part last;
        vertical and horizontal field of view, rad.
    rays : Tensor (S, 7, y', x')
        Of the branch of rays: direction, origin and the logarithm of the confidence minus 1 at the centres of a grid of
        cells that fills the image. Exactly one of both is not None.
    """

    depth: Tensor
    cameras: Tensor | None
    rays: Tensor | None


class DepthAnything3Views(DepthAnything3):
    """Network of the depth and the cameras of several views of a scene.

    Cameras come from the decoder of cameras, or from rays; the encoder of given cameras is left out.
    """

    def __init__(self, config: DepthAnything3Config, has_rays: bool = False):
        super().__init__(config, has_rays)
        self.cam_dec = None if has_rays else CameraDecoder(2 * config.width)

    def forward(self, pixels: Tensor) -> Views:
        """Estimate the depth and the cameras of views (S, 3, y, x) of one scene, as `DepthAnything3` takes images."""
        features = self.backbone["pretrained"](pixels, num_views=len(pixels))
        with torch.autocast(pixels.device.type, enabled=False):
            dense = self._dense(features.cells, pixels)
            cameras = None if self.cam_dec is None else self.cam_dec(features.cameras.to(self.head.norm.weight.dtype))
        return Views(dense.depth[:, 0], cameras, dense.rays)
