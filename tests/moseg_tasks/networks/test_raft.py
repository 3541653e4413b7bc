import numpy as np
import pytest
import torch

from moseg.tasks.networks.raft import LARGE, SMALL, Raft, RaftConfig
from moseg.tasks.networks.raft.correlation import CorrelationPyramid
from moseg.tasks.networks.raft.upsampling import upsample_bilinear, upsample_convex

WIDTHS = {"stage_channels": (8, 12, 16), "feature_channels": 12, "hidden_channels": 10, "context_channels": 14}
CONFIGS = {
    "large": RaftConfig.model_validate(LARGE.model_dump() | WIDTHS | {"motion_channels": 20, "mask_channels": 8}),
    "small": RaftConfig.model_validate(SMALL.model_dump() | WIDTHS | {"motion_channels": 20}),
}
SIZES = sorted(CONFIGS)
# Flow after five steps at every 64th pixel of both sides, as torchvision's module gives it with the same tensors.
GOLDEN = {
    "large": [
        [[0.688310189, 0.962734713, -0.222846954], [0.590400029, 0.704711461, -0.808729836]],
        [[0.996950009, 2.014378899, 0.567576663], [1.81367829, 0.901927226, -0.019246893]],
    ],
    "small": [
        [[0.608695532, -2.545753346, -1.908020676], [-2.923063488, -5.721924974, -3.746817234]],
        [[-0.124664861, 1.575627171, 4.259023548], [0.988549575, 0.714303336, -0.742902707]],
    ],
}


def random_raft(size: str) -> Raft:
    network = Raft(CONFIGS[size]).double().eval().requires_grad_(False)
    generator = torch.Generator().manual_seed(0)
    for key, value in network.state_dict().items():
        if value.is_floating_point():
            noise = torch.randn(value.shape, generator=generator, dtype=torch.float64)
            spread = (2 / value[0].numel()) ** 0.5 if value.ndim == 4 else 0.1
            value.copy_(noise * spread * (0.1 if "flow_head.conv2" in key else 1) + (".running_var" in key))
    return network


def random_images(height: int = 128, width: int = 136) -> list[torch.Tensor]:
    rng = np.random.default_rng(0)
    return [torch.from_numpy(rng.uniform(-1, 1, (1, 3, height, width))) for _ in range(2)]


@pytest.mark.parametrize("size", SIZES)
def test_flow_is_the_official_modules(size):
    flow = random_raft(size)(*random_images(), 5)
    assert flow.dtype == torch.float64 and flow.shape == (1, 2, 128, 136)
    np.testing.assert_allclose(flow[0, :, ::64, ::64].numpy(), GOLDEN[size], atol=1e-6)


@pytest.mark.parametrize("size", SIZES)
def test_correlations_on_demand_give_the_flow_of_those_held(size, monkeypatch):
    monkeypatch.setattr("moseg.tasks.networks.raft.correlation._MAX_BLOCK", 5000)
    network, images = random_raft(size), random_images()
    held, on_demand = (network(*images, 3, is_on_demand) for is_on_demand in (False, True))
    assert held.abs().max() > 0.1
    np.testing.assert_allclose(on_demand.numpy(), held.numpy(), atol=1e-9)


@pytest.mark.parametrize("size", SIZES)
def test_under_autocast_flow_stays_in_float32_and_near(size, in_half_precision, relative_error):
    network, images = random_raft(size).float(), [image.float() for image in random_images()]
    exact = network(*images, 4)
    half = in_half_precision(lambda: network(*images, 4))
    assert exact.dtype == half.dtype == torch.float32
    assert relative_error(half, exact) < 0.25


def test_a_look_up_is_the_bilinear_reading_of_averaged_correlations():
    rng = np.random.default_rng(0)
    features0, features1 = rng.normal(size=(2, 1, 5, 7, 9))
    position = np.array([4.3, 2.6])  # xy, of the cell (y, x) = (2, 3)
    positions = torch.from_numpy(np.broadcast_to(position[:, None, None], (1, 2, 7, 9)).copy())
    pyramid = CorrelationPyramid(torch.from_numpy(features0), torch.from_numpy(features1), levels=2, radius=2)
    found = pyramid.look_up(positions)[0, :, 2, 3].numpy().reshape(2, 5, 5)
    correlation = np.einsum("c,cyx->yx", features0[0, :, 2, 3], features1[0]) / np.sqrt(5)
    averaged = correlation[:6, :8].reshape(3, 2, 4, 2).mean(axis=(1, 3))
    for level, values in enumerate((correlation, averaged)):
        padded = np.pad(values, 20)
        for i, dx in enumerate(range(-2, 3)):
            for j, dy in enumerate(range(-2, 3)):
                x, y = position / 2**level + (dx, dy)
                (x0, fx), (y0, fy) = ((int(np.floor(v)) + 20, v - np.floor(v)) for v in (x, y))
                corner = padded[y0 : y0 + 2, x0 : x0 + 2]
                expected = np.array([1 - fy, fy]) @ corner @ np.array([1 - fx, fx])
                assert found[level, i, j] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("far", [1e4, -1e12, float("inf"), float("nan")])
def test_correlations_outside_the_frame_are_zero(far):
    features = torch.ones(1, 4, 8, 8)
    pyramid = CorrelationPyramid(features, features, levels=2, radius=1)
    found = pyramid.look_up(torch.full((1, 2, 8, 8), far))
    assert found.shape == (1, 18, 8, 8)
    assert not found.nan_to_num().any()


def test_correlations_of_half_features_are_summed_in_float32():
    features = torch.full((1, 256, 8, 8), 100.0, dtype=torch.float16)
    with torch.autocast("cpu", dtype=torch.bfloat16):
        found = CorrelationPyramid(features, features, levels=1, radius=0).look_up(torch.zeros(1, 2, 8, 8))
    # 256 * 100 * 100 / sqrt(256): beyond float16, and between two numbers of bfloat16.
    assert found.dtype == torch.float32 and (found == 160000).all()


def test_a_constant_flow_upsamples_to_itself_in_pixels():
    flow = torch.tensor([1.5, -0.25]).view(1, 2, 1, 1).expand(1, 2, 6, 7)
    logits = torch.randn(1, 576, 6, 7, generator=torch.Generator().manual_seed(0))
    for large in (upsample_convex(flow, logits)[..., 8:-8, 8:-8], upsample_bilinear(flow)):
        torch.testing.assert_close(large, 8 * flow[..., :1, :1].expand_as(large))


def test_convex_weights_are_read_by_neighbour_then_row_then_column():
    flow = torch.arange(18.0).view(1, 2, 3, 3)
    logits = torch.zeros(1, 9, 8, 8, 3, 3)
    logits[0, 5, 2, 7, 1, 1] = 100  # the right neighbour, for row 2 and column 7 of the middle cell
    large = upsample_convex(flow, logits.view(1, 576, 3, 3))
    torch.testing.assert_close(large[0, :, 8 + 2, 8 + 7], 8 * flow[0, :, 1, 2])
    torch.testing.assert_close(large[0, :, 8 + 3, 8 + 7], 8 * flow[0].mean(dim=(1, 2)))


@pytest.mark.parametrize(("config", "side"), [(LARGE, 128), (SMALL, 128), (RaftConfig(correlation_levels=2), 32)])
def test_the_minimal_side_leaves_the_coarsest_level_two_cells(config, side):
    with torch.device("meta"):
        assert Raft(config).min_side == side
