"""Inverse depth by DINOv2 with a DPT head."""

import numpy as np
import torch
from torch.nn import functional

from moseg.schemas.parameters.dpt_dinov2 import DptDinov2Params
from moseg.tasks.networks.depth import PATCH, DptDinov2
from moseg.tasks.networks.frame_tensor import normalise


def predict_dpt_dinov2(network: DptDinov2, images: np.ndarray, params: DptDinov2Params) -> torch.Tensor:
    """Predict inverse depth float32 (B, y, x), 1/m, of uint8 (B, y, x, 3) frames.

    The frames keep their size (up to `max_side`) and get a border of zeros to multiples of a patch, as in the official
    preprocessing. Depths are clamped to the range of the training, as there. The official post-processing then
    resizes the prediction of frame and border to the frame, which shifts the frame's edges by up to 6 px; here the
    border is cropped.
    """
    height, width = images.shape[1:3]
    scale = min(1.0, params.max_side / max(height, width))
    inner = (max(round(scale * height), 1), max(round(scale * width), 1))
    pixels = see_frames(images, inner, network.model.device)
    (top, bottom), (left, right) = (_border(side) for side in inner)
    padded = functional.pad(pixels, (left, right, top, bottom))
    depth = network.model(padded).predicted_depth.float() + network.min_depth
    # Inverted before it is resized: inverse depth, not depth, is linear over a plane's image.
    # Clamping would turn non-finite depths into the largest one.
    inverse = torch.where(depth.isfinite(), 1 / depth.clamp(max=network.max_depth).clamp(min=params.nearest), torch.nan)
    inverse = resize_maps(inverse, tuple(padded.shape[2:]))
    inverse = inverse[:, top : top + inner[0], left : left + inner[1]]
    return resize_maps(inverse, (height, width))


def _border(side: int) -> tuple[int, int]:
    """Return the pixels before and behind a side that centre it in the next multiple of a patch."""
    missing = -side % PATCH
    return missing // 2, missing - missing // 2


def see_frames(images: np.ndarray, size: tuple[int, int], device: torch.device) -> torch.Tensor:
    """Convert frames to float32 (B, 3, *size) on the device, normalised by ImageNet's mean and standard deviation.

    They are resized on the CPU, with antialiasing and rounded to grey levels, so that all devices get the same input.
    """
    # Copied, because torch warns of read-only arrays.
    pixels = torch.from_numpy(np.array(images)).permute(0, 3, 1, 2)
    if pixels.shape[2:] != size:
        pixels = functional.interpolate(pixels, size=size, mode="bilinear", antialias=True)
    return normalise(pixels.float() / 255).to(device)


def resize_maps(maps: torch.Tensor, size: tuple[int, int]) -> torch.Tensor:
    """Resize maps (B, y, x) bilinearly: no value leaves the range of its neighbours."""
    if maps.shape[1:] == size:
        return maps
    return functional.interpolate(maps[:, None], size=size, mode="bilinear")[:, 0]
