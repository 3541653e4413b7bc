"""The motion network in torch, in ONNX, and back."""

import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.tasks.motion_network import CHANNELS, motion_network_logit, read_network
from moseg.tasks.motion_network.export import to_onnx
from moseg.tasks.motion_network.restore import from_onnx
from moseg.tasks.motion_network.unet import MotionUNet


@pytest.fixture(scope="module")
def network():
    """Return a network with random weights whose normalisations have seen something."""
    torch.manual_seed(0)
    network = MotionUNet()
    with torch.no_grad():
        network(2 * torch.randn(2, len(CHANNELS), 32, 32) + 1)
        for layer in network.modules():
            if isinstance(layer, torch.nn.BatchNorm2d):
                layer.weight.uniform_(0.5, 2)
                layer.bias.normal_()
    return network.eval()


@pytest.fixture(scope="module")
def content(network):
    return to_onnx(network)


@pytest.mark.parametrize("shape", [(16, 32), (48, 16)])
def test_opencv_gives_the_logit_of_torch(network, content, shape):
    channels = np.random.default_rng(0).standard_normal((len(CHANNELS), *shape)).astype(np.float32)
    with torch.no_grad():
        expected = network(torch.from_numpy(channels)[None])[0, 0].numpy()
    np.testing.assert_allclose(motion_network_logit(read_network(content), channels), expected, atol=1e-4)


def test_sides_of_any_length_are_padded_and_cut_again(content):
    channels = np.zeros((len(CHANNELS), 21, 35), np.float16)
    assert motion_network_logit(read_network(content), channels).shape == (21, 35)


def test_a_restored_network_is_the_exported_one(network, content):
    restored = from_onnx(content)
    channels = torch.randn(1, len(CHANNELS), 32, 48)
    with torch.no_grad():
        torch.testing.assert_close(restored(channels), network(channels), atol=1e-4, rtol=1e-4)
    again = from_onnx(to_onnx(restored))
    for first, second in zip(again.parameters(), restored.parameters(), strict=True):
        torch.testing.assert_close(first, second)


@pytest.mark.parametrize("spoil", [lambda content: b"nonsense" * 9, lambda content: content[:999], lambda content: b""])
def test_what_is_no_network_is_bad_input(content, spoil):
    for read in (from_onnx, read_network):
        with pytest.raises(InputError, match="not a motion network"):
            read(spoil(content))
