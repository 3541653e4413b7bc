import numpy as np
import pytest
import torch
from PIL import Image

from moseg.tasks.networks.frame_tensor import IMAGENET_MEAN, IMAGENET_STD, Resizing, frame_tensor

CPU = torch.device("cpu")


def grey_levels(tensor):
    return tensor[0].permute(1, 2, 0).numpy() * np.float32(IMAGENET_STD) * 255 + np.float32(IMAGENET_MEAN) * 255


@pytest.mark.parametrize("size", [(96, 128), (150, 200), (48, 64), (31, 150)])
@pytest.mark.parametrize("kind", ["bilinear", "bicubic"])
def test_frames_are_resized_as_by_pil(frame, size, kind):
    wanted = np.asarray(Image.fromarray(frame).resize(size[::-1], Image.Resampling[kind.upper()])).astype(float)
    np.testing.assert_allclose(grey_levels(frame_tensor(frame, size, CPU, Resizing(f"pil-{kind}"))), wanted, atol=1e-3)


def test_resizing_by_torch_does_not_round_to_grey_levels(frame):
    found = grey_levels(frame_tensor(frame, (48, 64), CPU, Resizing.TORCH_BILINEAR))
    rounded = grey_levels(frame_tensor(frame, (48, 64), CPU))
    assert np.abs(found - rounded).max() < 1.6
    assert np.abs(found - np.round(found)).max() > 0.3


def test_a_frame_of_the_right_size_is_only_normalised(frame):
    tensor = frame_tensor(frame, (96, 128), CPU)
    assert tensor.dtype == torch.float32 and tensor.shape == (1, 3, 96, 128)
    np.testing.assert_allclose(grey_levels(tensor), frame, atol=1e-3)
