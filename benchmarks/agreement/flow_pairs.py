"""Comparison of two implementations of a network that estimates flow: the same random weights and image pairs."""

import contextlib
from collections.abc import Callable, Iterator, Mapping
from unittest import mock

import cv2
import numpy as np
import torch

from moseg.tasks.networks import Checkpoint

SIZES = ((128, 192), (136, 256))
NEAR_ONE = ("running_var", "gamma", ".1.weight", "norm.weight", "norm1.weight", *(f"bn{k}.weight" for k in (1, 2, 3)))
"""Ends of the names of tensors of one dimension that are about one: variances and scales."""


def compare(
    network: torch.nn.Module,
    run: Callable[[list[torch.Tensor]], torch.Tensor],
    build: Callable[[Checkpoint], torch.nn.Module],
    iterations: int,
    gains: Mapping[str, float],
    dtype: torch.dtype,
) -> tuple[float, float, float, float]:
    """Return the largest flow and differences over all pairs: ours to theirs, held and on demand; theirs to theirs.

    The last shows the precision: their own change if the images change in the last digit.
    """
    tensors = random_state(network.state_dict(), gains)
    network.load_state_dict(tensors)
    network.to(dtype).eval()
    ours = build(Checkpoint("random", tensors)).to(dtype)
    figures = np.zeros(4)
    for seed, size in enumerate(SIZES):
        pair = [image.to(dtype) for image in image_pair(size, seed)]
        theirs = run(pair)
        held, on_demand = (ours(*(to_unit(image) for image in pair), iterations, way) for way in (False, True))
        nudged = run([image * (1 + torch.finfo(dtype).eps) for image in pair])
        found = [theirs, held - theirs, on_demand - theirs, nudged - theirs]
        figures = np.maximum(figures, [float(values.abs().max()) for values in found])
    return tuple(figures.tolist())


def random_state(state: dict[str, torch.Tensor], gains: Mapping[str, float]) -> dict[str, torch.Tensor]:
    """Return random tensors of the same names and shapes, with gains that keep the flow in the image and nonzero."""
    generator = torch.Generator().manual_seed(0)
    made: dict[int, torch.Tensor] = {}
    for key, value in state.items():
        # Two names of one tensor (princeton's norm3 or bn3, and downsample) keep one value.
        if value.data_ptr() not in made:
            made[value.data_ptr()] = random_tensor(key, value, gains, generator)
    return {key: made[value.data_ptr()] for key, value in state.items()}


def random_tensor(
    key: str, value: torch.Tensor, gains: Mapping[str, float], generator: torch.Generator
) -> torch.Tensor:
    if not value.is_floating_point():
        return value.clone()
    noise = torch.randn(value.shape, generator=generator, dtype=torch.float32)
    if value.ndim > 1:
        gain = next((gain for part, gain in gains.items() if part in key), 1.0)
        return gain * noise * (2 / value[0].numel()) ** 0.5
    return 1 + 0.2 * noise.clamp(-2, 2) if key.endswith(NEAR_ONE) else 0.1 * noise


def image_pair(size: tuple[int, int], seed: int) -> list[torch.Tensor]:
    """Return a smooth texture, and the same slightly shifted and changed: (1, 3, y, x) in [0, 255]."""
    rng = np.random.default_rng(seed)
    noise = cv2.GaussianBlur(rng.normal(size=(*size, 3)), (0, 0), 2.0)
    first = 127 + 40 * noise / noise.std()
    second = np.roll(first, (3, -5), axis=(0, 1)) + rng.normal(scale=2.0, size=first.shape)
    return [torch.from_numpy(np.clip(image, 0, 255).transpose(2, 0, 1)[None].copy()) for image in (first, second)]


def to_unit(image: torch.Tensor) -> torch.Tensor:
    return 2 * (image / 255) - 1


@contextlib.contextmanager
def default_dtype(dtype: torch.dtype) -> Iterator[None]:
    """Run official code in a precision that it does not provide: it uses float32 by default and by `float()`."""
    before = torch.get_default_dtype()
    torch.set_default_dtype(dtype)
    try:
        with mock.patch.object(torch.Tensor, "float", lambda tensor: tensor.to(dtype)):
            yield
    finally:
        torch.set_default_dtype(before)
