"""Replacements of the few functions of torchvision that the authors' preprocessing calls, so that it is not needed.

On an image of PIL ``Resize`` is PIL's own, bilinear; on a tensor it is torch's bilinear interpolation with smoothing.
"""

import sys
import types

import numpy as np
import torch
from PIL import Image


def resize(image: Image.Image | torch.Tensor, size: tuple[int, int]) -> Image.Image | torch.Tensor:
    """Return an image at a height and width."""
    if isinstance(image, Image.Image):
        return image.resize(tuple(size)[::-1], Image.Resampling.BILINEAR)
    return torch.nn.functional.interpolate(image[None], size=tuple(size), mode="bilinear", antialias=True)[0]


def to_tensor(image: Image.Image | np.ndarray) -> torch.Tensor:
    """Return (3, y, x) in [0, 1]."""
    return torch.from_numpy(np.array(image)).permute(2, 0, 1).float() / 255


def normalize(image: torch.Tensor, mean, std) -> torch.Tensor:
    mean, std = (torch.tensor(values).view(3, 1, 1) for values in (mean, std))
    return (image - mean) / std


class Resize(torch.nn.Module):
    def __init__(self, size):
        super().__init__()
        self.size = size

    def forward(self, image):
        return resize(image, self.size)


class ToTensor:
    def __call__(self, image):
        return to_tensor(image)


class Normalize(torch.nn.Module):
    def __init__(self, mean, std):
        super().__init__()
        self.mean, self.std = mean, std

    def forward(self, image):
        return normalize(image, self.mean, self.std)


class Compose:
    def __init__(self, transforms):
        self.transforms = transforms

    def __call__(self, image):
        for transform in self.transforms:
            image = transform(image)
        return image


def keep_best(boxes: torch.Tensor, scores: torch.Tensor, max_iou: float) -> torch.Tensor:
    """Return the indices of the boxes (n, 4) that ``torchvision.ops.nms`` keeps, best first."""
    kept: list[int] = []
    for index in scores.argsort(descending=True, stable=True).tolist():
        low = torch.maximum(boxes[index, :2], boxes[kept, :2])
        high = torch.minimum(boxes[index, 2:], boxes[kept, 2:])
        shared = (high - low).clamp(min=0).prod(dim=1)
        areas = (boxes[:, 2:] - boxes[:, :2]).prod(dim=1)
        if not (shared > max_iou * (areas[kept] + areas[index] - shared)).any():
            kept.append(index)
    return torch.tensor(kept, dtype=torch.long)


def stand_in() -> None:
    """Register the functions where the authors' code imports them from."""
    for name in ("torchvision", "torchvision.transforms", "torchvision.transforms.functional", "torchvision.ops"):
        if name not in sys.modules:
            sys.modules[name] = types.ModuleType(name)
            sys.modules[name].__path__ = []
    root, transforms = sys.modules["torchvision"], sys.modules["torchvision.transforms"]
    functional = sys.modules["torchvision.transforms.functional"]
    vars(functional).update(resize=resize, to_tensor=to_tensor, normalize=normalize, to_pil_image=Image.fromarray)
    vars(transforms).update(
        Resize=Resize, ToTensor=ToTensor, Normalize=Normalize, Compose=Compose, functional=functional
    )
    vars(root).update(transforms=transforms, ops=sys.modules["torchvision.ops"])
