"""Inverse depth by Depth Anything V2."""

import numpy as np
import torch
from transformers import DepthAnythingForDepthEstimation

from moseg_tasks.depth.pixels import PATCH, resize_maps, see_frames
from schemas.parameters.depth_anything import DepthAnythingParams


def predict_depth_anything(
    model: DepthAnythingForDepthEstimation, images: np.ndarray, params: DepthAnythingParams
) -> torch.Tensor:
    """Inverse depth float32 (B, y, x), up to scale and shift, of uint8 (B, y, x, 3) frames.

    The frame is resized to `short_side`, whether it shrinks or grows, as the network's authors do; its processor in
    transformers fits frames smaller than 518 px by their longer side instead.
    """
    size = images.shape[1:3]
    pixels = see_frames(images, network_size(size, params), "bicubic", model.device)
    return resize_maps(model(pixels).predicted_depth.float(), size)


def network_size(size: tuple[int, int], params: DepthAnythingParams) -> tuple[int, int]:
    """Height and width at which the network sees frames of a size: multiples of a patch, nearly of their aspect."""
    scale = min(params.short_side / min(size), params.max_side / max(size))
    height, width = (max(round(scale * side / PATCH), 1) * PATCH for side in size)
    return height, width
