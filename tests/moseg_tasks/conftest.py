"""Tiny networks of transformers, as they are built from the files of their checkpoints.

Imported where they are asked for: torch and transformers take seconds that the other tests need not wait.
"""

from collections.abc import Callable

import cv2
import numpy as np
import pytest


@pytest.fixture(scope="session")
def read_tiny() -> Callable:
    """Makes a Checkpoint of a TinyCheckpoint with safetensors."""
    from safetensors.torch import load

    from moseg.tasks.networks import Checkpoint

    def read(tiny):
        documents = {name: text.decode() for name, text in tiny.files.items() if name != "model.safetensors"}
        return Checkpoint("tiny", load(tiny.files["model.safetensors"]), documents, tiny.config)

    return read


@pytest.fixture(scope="session")
def grounding_dino_checkpoint(read_tiny):
    from moseg.workflows.weights.tiny.grounding_dino import make_grounding_dino

    return read_tiny(make_grounding_dino(0))


@pytest.fixture(scope="session")
def sam_hq_checkpoint(read_tiny):
    from moseg.workflows.weights.tiny.sam_hq import make_sam_hq

    return read_tiny(make_sam_hq(0))


@pytest.fixture(scope="session")
def detector(grounding_dino_checkpoint):
    from moseg.tasks.networks.grounding_dino import build_grounding_dino

    return build_grounding_dino(grounding_dino_checkpoint)


@pytest.fixture(scope="session")
def sam_hq(sam_hq_checkpoint):
    from moseg.tasks.networks.sam_hq import build_sam_hq

    return build_sam_hq(sam_hq_checkpoint)


@pytest.fixture(scope="session")
def with_unit_gain() -> Callable:
    """Gives a checkpoint random weights that all matter: biases a tenth, norms about one, others of unit gain."""
    import torch

    def fill(checkpoint):
        generator = torch.Generator().manual_seed(0)
        tensors = {}
        for name, value in sorted(checkpoint.tensors.items()):
            noise = torch.randn(value.shape, generator=generator, dtype=torch.float64)
            is_gain = "norm" in name.lower() and name.endswith("weight")
            tensors[name] = noise * value[0].numel() ** -0.5 if value.ndim > 1 else 0.1 * noise + is_gain
        return checkpoint._replace(tensors=tensors)

    return fill


@pytest.fixture(scope="session")
def in_half_precision() -> Callable:
    """Calls a function as on a GPU, but in bfloat16, and sees to it that layers of a network really ran in that.

    What a random network says in half precision differs from CPU to CPU, and where it is near a threshold so does what
    is decided by it. Compare numbers before the threshold, by `relative_error`.
    """
    import torch
    from torch.nn.modules.module import register_module_forward_hook

    def call(function):
        kinds = set()
        hook = register_module_forward_hook(lambda _, __, output: kinds.add(getattr(output, "dtype", None)))
        try:
            with torch.autocast("cpu", dtype=torch.bfloat16):
                found = function()
        finally:
            hook.remove()
        assert torch.bfloat16 in kinds
        return found

    return call


@pytest.fixture(scope="session")
def relative_error() -> Callable:
    """Root mean square of the difference from what is exact, as a share of the exact's spread: over 1 if unrelated.

    Roundings to bfloat16, of 0.4 % each, add up to some per cent through the layers of a network.
    """

    def error(found, exact) -> float:
        found, exact = (np.asarray(values, np.float64) for values in (found, exact))
        assert np.isfinite(found).all()
        return float(np.sqrt(np.mean((found - exact) ** 2)) / exact.std())

    return error


@pytest.fixture(scope="session")
def frame() -> np.ndarray:
    """A smooth random RGB frame of 96 by 128 px."""
    noise = np.random.default_rng(0).integers(0, 256, (96, 128, 3), dtype=np.uint8)
    return cv2.GaussianBlur(noise, (0, 0), 3)
