"""A frame as the input of a network trained on ImageNet-normalised RGB."""

import numpy as np
import torch
from torch.nn import functional

from schemas.errors import InputError

IMAGENET_MEAN = (0.485, 0.456, 0.406)
IMAGENET_STD = (0.229, 0.224, 0.225)


def frame_tensor(image: np.ndarray, size: tuple[int, int], device: torch.device) -> torch.Tensor:
    """The frame, resized and normalised.

    The published networks were run on images that PIL had resized: bilinear, antialiased where the image shrinks, and
    rounded to 8 bits. This agrees with it to one grey level, on every device.

    Parameters
    ----------
    image : uint8 (y, x, 3)
        RGB.
    size : (int, int)
        Height and width asked for, px.
    device : torch.device

    Returns
    -------
    torch.Tensor
        float32 (1, 3, *size).

    Raises
    ------
    InputError
        It is not an RGB frame.
    """
    check_frame(image)
    # Copied, as torch warns of arrays that are read-only.
    pixels = torch.from_numpy(np.array(image)).permute(2, 0, 1)[None]
    if pixels.shape[2:] != tuple(size):
        pixels = functional.interpolate(pixels, size=tuple(size), mode="bilinear", antialias=True)
    mean, std = (torch.tensor(values).view(1, 3, 1, 1) for values in (IMAGENET_MEAN, IMAGENET_STD))
    return ((pixels.float() / 255 - mean) / std).to(device)


def check_frame(image: np.ndarray) -> None:
    """Raise InputError where this is not an RGB frame: uint8 (y, x, 3)."""
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] != 3 or image.size == 0:
        raise InputError("not an RGB frame", got=f"{image.dtype} {image.shape}", expected="uint8 (y, x, 3)")
