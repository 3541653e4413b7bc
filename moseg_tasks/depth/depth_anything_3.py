"""Inverse depth by Depth Anything 3."""

import cv2
import numpy as np
import torch

from moseg.schemas.parameters.depth_anything_3 import DepthAnything3Params
from moseg.tasks.depth.dpt_dinov2 import resize_maps
from moseg.tasks.networks.depth import PATCH
from moseg.tasks.networks.depth_anything_3 import DepthAnything3
from moseg.tasks.networks.frame_tensor import normalise


def predict_depth_anything_3(network: DepthAnything3, images: np.ndarray, params: DepthAnything3Params) -> torch.Tensor:
    """Predict inverse depth float32 (B, y, x), up to a factor of each frame, of uint8 (B, y, x, 3) frames.

    Each frame is a scene of its own. The authors leave depth at the size of the network's input; here it is inverted,
    and then resized to the frame, because inverse depth, not depth, is linear over a plane's image.
    """
    pixels = images_to_pixels(images, params.side).to(network.device)
    return resize_maps((-network(pixels)).exp(), images.shape[1:3])


def images_to_pixels(images: np.ndarray, side: int) -> torch.Tensor:
    """Return the network's input (B, 3, y, x) of frames uint8 (B, y, x, 3) of one size."""
    seen = np.stack([resize_to_patches(image, side) for image in images])
    return normalise(torch.from_numpy(seen).permute(0, 3, 1, 2).float() / 255)


def resize_to_patches(image: np.ndarray, side: int) -> np.ndarray:
    """Resize a frame uint8 (y, x, 3) by the authors' two steps: to a longer side of `side` px, then to whole patches.

    Each step rounds to grey levels, and interpolates bicubically if it enlarges a side, otherwise by areas.
    """
    scale = side / max(image.shape[:2])
    size = tuple(max(round(length * scale), 1) for length in image.shape[:2])
    return _resize(_resize(image, size), tuple(_whole_patches(length) for length in size))


def _whole_patches(length: int) -> int:
    """Return the nearest multiple of a patch, the larger one of two, and at least one."""
    return max((length + PATCH // 2) // PATCH, 1) * PATCH


def _resize(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    if image.shape[:2] == size:
        return image
    is_enlarged = size[0] > image.shape[0] or size[1] > image.shape[1]
    return cv2.resize(image, size[::-1], interpolation=cv2.INTER_CUBIC if is_enlarged else cv2.INTER_AREA)
