import io

import cv2
import numpy as np
import pytest
import torch
from safetensors.torch import load

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.raft import RaftParams
from moseg.tasks.flow.raft import estimate_raft_flow
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.raft import build_raft
from moseg.tasks.networks.sea_raft import build_sea_raft
from moseg.workflows.weights.tiny.raft import make_raft
from moseg.workflows.weights.tiny.sea_raft import make_sea_raft

QUICK = RaftParams(iterations=3)


@pytest.fixture(scope="module", params=["raft", "sea-raft"])
def tiny(request):
    """Return a network of the tiny checkpoint of each architecture."""
    if request.param == "raft":
        files, config = make_raft(seed=0)
        tensors = torch.load(io.BytesIO(files["model.pth"]), weights_only=True)
        return build_raft(Checkpoint("tiny", tensors, config=config))
    files, config = make_sea_raft(seed=0)
    return build_sea_raft(Checkpoint("tiny", load(files["model.safetensors"]), config=config))


class FirstImageAsFlow(torch.nn.Module):
    """Gives the first two channels of the first images as flow: shows what became of each pixel."""

    min_side = 128

    def __init__(self):
        super().__init__()
        self.weight = torch.nn.Parameter(torch.zeros(1))

    def forward(self, images0, images1, iterations, on_demand=False):
        assert images0.shape == images1.shape and images0.shape[2] % 8 == images0.shape[3] % 8 == 0
        assert min(images0.shape[2:]) >= self.min_side
        return images0[:, :2]


def texture(shape, seed=0):
    """Smooth random RGB frames."""
    noise = np.random.default_rng(seed).integers(0, 256, (*shape, 3), np.uint8)
    smooth = [(cv2.GaussianBlur(image, (0, 0), 2.0).astype(np.float32) - 127) * 5 + 127 for image in noise]
    return np.clip(smooth, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("shape", [(1, 1), (3, 200), (96, 128), (130, 141), (250, 20)])
def test_each_pixel_keeps_its_flow_whatever_the_padding(shape):
    images = texture((2, *shape))
    flow = estimate_raft_flow(FirstImageAsFlow(), images, images, QUICK)
    assert flow.dtype == np.float32 and flow.flags.c_contiguous
    np.testing.assert_allclose(flow, images[..., :2] / 127.5 - 1, atol=1e-6)


def test_flow_found_in_reduced_frames_is_in_pixels_of_the_whole_ones():
    images = np.full((1, 101, 300, 3), 255, np.uint8)
    flow = estimate_raft_flow(FirstImageAsFlow(), images, images, RaftParams(max_side=128))
    assert flow.shape == (1, 101, 300, 2)
    # 43 x 128 is the size at which the flow of one pixel was found.
    np.testing.assert_allclose(flow[0].reshape(-1, 2), np.broadcast_to([300 / 128, 101 / 43], (30300, 2)), rtol=1e-6)


def test_frames_are_reduced_by_averaging_areas(tiny):
    images0, images1 = texture((1, 128, 160), 0), texture((1, 128, 160), 1)
    doubled = (np.repeat(np.repeat(images, 2, axis=1), 2, axis=2) for images in (images0, images1))
    capped = estimate_raft_flow(tiny, *doubled, RaftParams(iterations=3, max_side=160))
    flow = estimate_raft_flow(tiny, images0, images1, QUICK)
    np.testing.assert_allclose(capped[0], 2 * cv2.resize(flow[0], (320, 256)), atol=1e-4)


def test_a_cap_at_the_longer_side_changes_nothing(tiny):
    images0, images1 = texture((1, 90, 136), 0), texture((1, 90, 136), 1)
    flows = [estimate_raft_flow(tiny, images0, images1, RaftParams(iterations=3, max_side=m)) for m in (136, 1024)]
    assert np.array_equal(*flows)


def test_a_batch_gives_the_flow_of_each_pair_alone(tiny):
    images0, images1 = texture((3, 96, 136), 0), texture((3, 96, 136), 1)
    flow = estimate_raft_flow(tiny, images0, images1, QUICK)
    alone = [estimate_raft_flow(tiny, images0[[k]], images1[[k]], QUICK)[0] for k in range(3)]
    np.testing.assert_allclose(flow, alone, atol=1e-4)
    assert np.abs(flow[0] - flow[1]).max() > 0.1


def test_flow_depends_on_the_second_image_and_stays_in_the_frame(tiny):
    images0, images1 = texture((1, 96, 128), 0), texture((1, 96, 128), 1)
    flow, still = (estimate_raft_flow(tiny, images0, images, RaftParams()) for images in (images1, images0))
    assert np.abs(flow - still).max() > 0.1
    assert 0.5 < np.abs(flow).max() < 40


@pytest.mark.parametrize("correlation", ["volume", "on_demand"])
def test_the_same_frames_give_the_same_bytes(tiny, correlation):
    images0, images1 = texture((1, 96, 128), 0), texture((1, 96, 128), 1)
    for images in (images0, images1):
        images.setflags(write=False)
    params = RaftParams(iterations=3, correlation=correlation)
    flows = [estimate_raft_flow(tiny, images0, images1, params).tobytes() for _ in range(2)]
    assert flows[0] == flows[1]


def test_both_ways_to_correlate_give_one_flow(tiny):
    images0, images1 = texture((2, 128, 160), 0), texture((2, 128, 160), 1)
    held, on_demand = (
        estimate_raft_flow(tiny, images0, images1, RaftParams(correlation=way)) for way in ("volume", "on_demand")
    )
    np.testing.assert_allclose(on_demand, held, atol=1e-4)


def test_under_autocast_flow_is_float32_and_finite(tiny):
    images0, images1 = texture((1, 96, 128), 0), texture((1, 96, 128), 1)
    with torch.autocast("cpu", dtype=torch.bfloat16):
        flow = estimate_raft_flow(tiny, images0, images1, QUICK)
    assert flow.dtype == np.float32 and np.isfinite(flow).all()


@pytest.mark.parametrize(
    ("images0", "images1", "message"),
    [
        (np.zeros((8, 8, 3), np.uint8), np.zeros((8, 8, 3), np.uint8), "not a batch of RGB frames in images0"),
        (np.zeros((1, 8, 8, 3), np.uint8), np.zeros((1, 8, 8, 3)), "not a batch of RGB frames in images1"),
        (np.zeros((0, 8, 8, 3), np.uint8), np.zeros((0, 8, 8, 3), np.uint8), "not a batch of RGB frames in images0"),
        (np.zeros((1, 8, 8, 3), np.uint8), np.zeros((1, 8, 9, 3), np.uint8), "differ in shape"),
        (np.zeros((1, 8, 8, 3), np.uint8), np.zeros((2, 8, 8, 3), np.uint8), "differ in shape"),
    ],
)
def test_other_than_two_batches_of_rgb_frames_of_one_size_is_an_input_error(images0, images1, message):
    with pytest.raises(InputError, match=message):
        estimate_raft_flow(FirstImageAsFlow(), images0, images1, QUICK)


def test_a_tiny_checkpoint_follows_from_its_seed():
    assert make_raft(3) == make_raft(3)
    assert make_raft(3).files != make_raft(4).files
    assert len(make_raft(3).files["model.pth"]) < 1_000_000
