import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.tasks.motion_network import CHANNELS, motion_network_logit, read_network


@pytest.fixture(scope="module")
def network():
    """A network whose normalisations have seen data, in evaluation."""
    import torch

    from moseg.tasks.motion_network.unet import MotionUNet

    torch.manual_seed(0)
    network = MotionUNet()
    with torch.no_grad():
        for _ in range(3):
            network(torch.randn(2, len(CHANNELS), 32, 48) * 2 + 1)
    return network.eval()


@pytest.mark.parametrize("shape", [(32, 48), (30, 41), (64, 17), (5, 5)])
def test_opencv_gives_the_logits_of_torch(network, shape):
    import torch

    from moseg.tasks.motion_network.export import to_onnx

    channels = np.random.default_rng(0).normal(0, 2, (len(CHANNELS), *shape)).astype(np.float32)
    logit = motion_network_logit(read_network(to_onnx(network)), channels)
    padded = np.pad(channels, ((0, 0), (0, -shape[0] % 16), (0, -shape[1] % 16)), mode="edge")
    with torch.no_grad():
        expected = network(torch.from_numpy(padded)[None])[0, 0, : shape[0], : shape[1]].numpy()
    assert logit.dtype == np.float32 and logit.shape == shape
    np.testing.assert_allclose(logit, expected, atol=1e-3 * np.abs(expected).max() + 1e-4)


def test_a_network_reads_frames_of_several_sizes_in_turn(network):
    from moseg.tasks.motion_network.export import to_onnx

    opened = read_network(to_onnx(network))
    channels = np.random.default_rng(0).normal(0, 2, (len(CHANNELS), 32, 48)).astype(np.float32)
    first = motion_network_logit(opened, channels)
    motion_network_logit(opened, channels[:, :16, :32])
    np.testing.assert_array_equal(motion_network_logit(opened, channels), first)


def test_the_export_has_the_same_bytes_each_time(network):
    from moseg.tasks.motion_network.export import to_onnx

    assert to_onnx(network) == to_onnx(network)


@pytest.mark.parametrize("content", [b"", b"not a network", bytes(200)])
def test_other_files_are_refused(content):
    with pytest.raises(InputError, match="not a motion network"):
        read_network(content)
