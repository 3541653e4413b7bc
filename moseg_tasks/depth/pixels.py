"""Frames as DPT-DINOv2 sees them, and its predictions back at the frames' size."""

import numpy as np
import torch
from torch.nn import functional

from moseg.tasks.networks.frame_tensor import IMAGENET_MEAN, IMAGENET_STD

PATCH = 14
"""Side of a patch of every DINOv2, px."""


def see_frames(images: np.ndarray, size: tuple[int, int], device: torch.device) -> torch.Tensor:
    """Frames as float32 (B, 3, *size) on the device, with ImageNet's mean and deviation.

    Resized on the CPU, smoothed first where they shrink and rounded to grey levels, so that every device sees the
    same.
    """
    # Copied, as torch warns of arrays that are read-only.
    pixels = torch.from_numpy(np.array(images)).permute(0, 3, 1, 2)
    if pixels.shape[2:] != size:
        pixels = functional.interpolate(pixels, size=size, mode="bilinear", antialias=True)
    mean, std = (torch.tensor(values).view(3, 1, 1) for values in (IMAGENET_MEAN, IMAGENET_STD))
    return ((pixels.float() / 255 - mean) / std).to(device)


def resize_maps(maps: torch.Tensor, size: tuple[int, int]) -> torch.Tensor:
    """Maps (B, y, x) at another size, bilinear: no value leaves the range of its neighbours."""
    if maps.shape[1:] == size:
        return maps
    return functional.interpolate(maps[:, None], size=size, mode="bilinear")[:, 0]
