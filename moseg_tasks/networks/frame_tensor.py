"""A frame as the input of a network trained on normalised RGB."""

from enum import StrEnum
from typing import NamedTuple

import numpy as np
import torch
from PIL import Image
from torch.nn import functional

from moseg.tasks.check_frame import check_frame

IMAGENET_MEAN = (0.485, 0.456, 0.406)
IMAGENET_STD = (0.229, 0.224, 0.225)


class Normalisation(NamedTuple):
    """Mean and standard deviation of RGB in 0..1, with which a network was trained."""

    mean: tuple[float, float, float]
    std: tuple[float, float, float]


IMAGENET = Normalisation(IMAGENET_MEAN, IMAGENET_STD)
SYMMETRIC = Normalisation((0.5, 0.5, 0.5), (0.5, 0.5, 0.5))
"""From -1 to 1."""


class Resizing(StrEnum):
    """Interpolation by which the authors of a network resized its images; all smooth where the image is reduced.

    PIL rounds to grey levels; torch, by which torchvision resizes tensors, does not.
    """

    PIL_BILINEAR = "pil-bilinear"
    PIL_BICUBIC = "pil-bicubic"
    TORCH_BILINEAR = "torch-bilinear"


_PIL = {Resizing.PIL_BILINEAR: Image.Resampling.BILINEAR, Resizing.PIL_BICUBIC: Image.Resampling.BICUBIC}


def frame_tensor(
    image: np.ndarray,
    size: tuple[int, int],
    device: torch.device,
    resizing: Resizing = Resizing.PIL_BILINEAR,
    normalisation: Normalisation = IMAGENET,
) -> torch.Tensor:
    """Resize and normalise a frame; it is resized on the CPU, so that all devices get the same input.

    Parameters
    ----------
    image : uint8 (y, x, 3)
        RGB.
    size : (int, int)
        Height and width of the result, px.
    device : torch.device
    resizing : Resizing
    normalisation : Normalisation

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
    size = tuple(size)
    if image.shape[:2] != size and resizing in _PIL:
        image = np.asarray(Image.fromarray(image).resize(size[::-1], _PIL[resizing]))
    # Copied, because torch warns of read-only arrays.
    pixels = torch.from_numpy(np.array(image)).permute(2, 0, 1)[None].float() / 255
    if pixels.shape[2:] != size:
        pixels = functional.interpolate(pixels, size=size, mode="bilinear", antialias=True)
    return normalise(pixels, normalisation).to(device)


def normalise(pixels: torch.Tensor, normalisation: Normalisation = IMAGENET) -> torch.Tensor:
    """Normalise RGB (B, 3, y, x) in 0..1."""
    mean, std = (torch.tensor(values).view(1, 3, 1, 1) for values in normalisation)
    return (pixels - mean) / std
