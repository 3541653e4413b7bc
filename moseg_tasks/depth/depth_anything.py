"""Inverse depth by Depth Anything V2."""

import cv2
import numpy as np
import torch
from torch.nn import functional
from transformers import DepthAnythingForDepthEstimation

from moseg.schemas.parameters.depth_anything import DepthAnythingParams
from moseg.tasks.networks.depth import PATCH
from moseg.tasks.networks.frame_tensor import IMAGENET_MEAN, IMAGENET_STD


def predict_depth_anything(
    model: DepthAnythingForDepthEstimation, images: np.ndarray, params: DepthAnythingParams
) -> torch.Tensor:
    """Predict inverse depth float32 (B, y, x), up to scale and shift, of uint8 (B, y, x, 3) frames.

    The frame is reduced or enlarged to `short_side` by OpenCV's bicubic interpolation without smoothing, as by the
    network's authors; its processor in transformers smooths, and fits frames smaller than 518 px by their longer side.
    The output is resized with aligned corners, as in the authors' code.
    """
    height, width = network_size(images.shape[1:3], params)
    seen = [cv2.resize(image / 255.0, (width, height), interpolation=cv2.INTER_CUBIC) for image in images]
    pixels = (np.stack(seen) - IMAGENET_MEAN) / IMAGENET_STD
    pixels = torch.from_numpy(pixels.transpose(0, 3, 1, 2).astype(np.float32)).to(model.device)
    inverse_depth = model(pixels).predicted_depth.float()
    return functional.interpolate(inverse_depth[:, None], size=images.shape[1:3], mode="bilinear", align_corners=True)[
        :, 0
    ]


def network_size(size: tuple[int, int], params: DepthAnythingParams) -> tuple[int, int]:
    """Return height and width of the network's input: multiples of a patch, nearly of the frame's aspect."""
    scale = min(params.short_side / min(size), params.max_side / max(size))
    height, width = (max(round(scale * side / PATCH), 1) * PATCH for side in size)
    return height, width
