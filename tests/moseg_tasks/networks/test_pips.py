import hashlib

import cv2
import numpy as np
import pytest
import torch
import torch.nn.functional as F

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.pips import Pips, PipsConfig, Resolution, build_pips
from moseg.tasks.networks.pips.correlation import correlate, feature_pyramid, sample_appearances
from moseg.tasks.networks.pips.mixer import encode_motion

SIZES = {"latent": 12, "widths": [8, 8, 12, 8], "encoding": 6, "hidden": 16, "depth": 2}
STATE_DICT_DIGEST = "2d7a8c6b293a303ab687635d3279ec92039e038de32994a3c927828e46ab6459"
NUM_POINTS = 5
GOLDEN_POINTS = [
    [[7.412902869, 28.222915353], [24.247311095, 22.880705817]],
    [[29.798038607, 19.015903791], [45.524137543, 13.613510387]],
]
GOLDEN_VISIBILITY = [[-1.165595898, -1.685185141], [-1.775375457, -2.168764654]]


def seeded_tensors(config=SIZES, seed=0):
    """A state dict that does not depend on torch's generators, with signals of about unit size in each layer."""
    rng = np.random.default_rng(seed)
    with torch.device("meta"):
        shapes = {name: tuple(value.shape) for name, value in Pips(PipsConfig(**config)).state_dict().items()}
    return {
        name: torch.from_numpy(rng.standard_normal(shape) / np.sqrt(max(np.prod(shape[1:]), 4)))
        for name, shape in shapes.items()
    }


@pytest.fixture
def network():
    return build_pips(Checkpoint("tiny", seeded_tensors(), config=SIZES)).double()


@pytest.fixture
def images():
    noise = np.random.default_rng(1).integers(0, 256, (8, 12, 16, 3), dtype=np.uint8)
    return torch.from_numpy(np.stack([cv2.resize(image, (64, 48), interpolation=cv2.INTER_CUBIC) for image in noise]))


@pytest.fixture
def points():
    return torch.from_numpy(np.random.default_rng(2).uniform(4, 44, (NUM_POINTS, 2)))


@torch.inference_mode()
def follow(network, images, points, iterations=3):
    pyramid = network.encode(images)
    return network(pyramid, points, network.appearances(pyramid, points), iterations)


def test_names_and_shapes_are_those_of_the_published_state_dict():
    with torch.device("meta"):
        tensors = Pips(PipsConfig()).state_dict()
    lines = "\n".join(sorted(f"{name} {tuple(value.shape)}" for name, value in tensors.items()))
    assert len(tensors) == 200
    assert sum(value.numel() for value in tensors.values()) == 28_677_713
    assert hashlib.sha256(lines.encode()).hexdigest() == STATE_DICT_DIGEST


def test_outputs_of_a_seeded_network_do_not_change(network, images, points):
    result = follow(network, images, points)
    np.testing.assert_allclose(result.points[:2, [1, 7]].numpy(), GOLDEN_POINTS, atol=1e-6)
    np.testing.assert_allclose(result.visibility[:2, [0, 7]].numpy(), GOLDEN_VISIBILITY, atol=1e-6)
    assert np.ptp(result.points.numpy(), axis=1).max() > 1


def test_a_network_is_built_to_be_run(network):
    built = build_pips(Checkpoint("half", {k: v.half() for k, v in seeded_tensors().items()}, config=SIZES))
    assert not built.training
    assert all(p.dtype == torch.float32 and not p.requires_grad and p.device.type == "cpu" for p in built.parameters())
    assert network.dtype == torch.float64


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda tensors: tensors.pop("norm.weight"), "tensors are missing in weights tiny; got norm.weight"),
        (lambda tensors: tensors.update(extra=torch.zeros(1)), "not the network's in weights tiny; got extra"),
        (lambda tensors: tensors.update({"norm.bias": torch.zeros(3)}), r"norm.bias \(3,\) instead of \(12,\)"),
    ],
)
def test_a_state_dict_that_is_not_the_networks_is_refused(change, message):
    tensors = seeded_tensors()
    change(tensors)
    with pytest.raises(InputError, match=message):
        build_pips(Checkpoint("tiny", tensors, config=SIZES))


def test_sizes_that_pips_cannot_have_are_an_input_error():
    with pytest.raises(InputError, match="invalid sizes in config of weights tiny; got stride"):
        build_pips(Checkpoint("tiny", seeded_tensors(), config=SIZES | {"stride": 0}))


def test_points_of_the_first_frame_do_not_move(network, images, points):
    torch.testing.assert_close(follow(network, images, points).points[:, 0], points)


def test_points_are_followed_each_for_itself(network, images, points):
    together = follow(network, images, points)
    order = torch.tensor([3, 0, 4])
    fewer = follow(network, images, points[order])
    torch.testing.assert_close(fewer.points, together.points[order])
    torch.testing.assert_close(fewer.visibility, together.visibility[order])


def test_frames_are_encoded_each_for_itself(network, images):
    with torch.inference_mode():
        together, alone = network.encode(images), network.encode(images[3:4])
    for level, single in zip(together, alone, strict=True):
        torch.testing.assert_close(level[3:4], single)
    assert [tuple(level.shape) for level in together] == [(8, 12, 16, 12), (8, 6, 8, 12), (8, 3, 4, 12), (8, 1, 2, 12)]


def test_half_precision_gives_full_precision_results_that_are_near(
    network, images, points, in_half_precision, relative_error
):
    network, points = network.float(), points.float()
    exact = follow(network, images, points, iterations=1)
    result = in_half_precision(lambda: follow(network, images, points, iterations=1))
    pyramid = in_half_precision(lambda: network.encode(images))
    assert {tensor.dtype for tensor in (*result, *pyramid)} == {torch.float32}
    moved = [found.points - points[:, None] for found in (result, exact)]
    assert relative_error(*moved) < 0.25
    assert relative_error(result.visibility, exact.visibility) < 0.25
    torch.testing.assert_close(result.points[:, 0], points)


def test_two_runs_are_equal_to_the_bit(network, images, points):
    first, second = (follow(network, images, points) for _ in range(2))
    assert torch.equal(first.points, second.points) and torch.equal(first.visibility, second.visibility)


def test_correlations_are_those_sampled_from_the_whole_volume():
    generator = torch.Generator().manual_seed(0)
    maps = torch.randn(3, 7, 16, 20, generator=generator, dtype=torch.float64)
    appearances = torch.randn(4, 3, 7, generator=generator, dtype=torch.float64)
    # Inside, across each edge, far outside, and at a cell's centre.
    positions = torch.rand(4, 3, 2, generator=generator, dtype=torch.float64) * 30 - 5
    positions[0, 0] = torch.tensor([5.0, 4.0])
    positions[1, 1] = torch.tensor([400.0, -300.0])
    got = correlate(feature_pyramid(maps, 3), appearances, positions, 2)

    offset = torch.arange(-2.0, 3.0, dtype=torch.float64)
    square = torch.stack(torch.meshgrid(offset, offset, indexing="ij"), dim=-1)
    expected, level = [], maps
    for index in range(3):
        volume = torch.einsum("nsc,scyx->nsyx", appearances, level) / 7**0.5
        size = torch.tensor(level.shape[-2:]).flip(0)
        grid = 2 * (positions[:, :, None, None] / 2**index + square) / (size - 1) - 1
        sampled = F.grid_sample(volume.flatten(0, 1)[:, None], grid.flatten(0, 1), align_corners=True)
        expected.append(sampled.view(4, 3, -1))
        level = F.avg_pool2d(level, 2)
    torch.testing.assert_close(got, torch.cat(expected, dim=2))


def test_appearances_are_bilinear_and_beyond_the_edge_the_edges():
    y, x = torch.meshgrid(torch.arange(4.0), torch.arange(6.0), indexing="ij")
    maps = torch.stack([x, y, x * y], dim=-1)
    at = torch.tensor([[1.25, 2.5], [0.0, 3.0], [-2.0, 1.0], [9.0, 9.0]])
    expected = torch.tensor([[1.25, 2.5, 3.125], [0, 3, 0], [0, 1, 0], [5, 3, 15]])
    torch.testing.assert_close(sample_appearances(maps, at), expected)


def test_motion_is_encoded_as_published():
    encoded = encode_motion(torch.tensor([[[0.0, 0.0], [0.001, -0.002]]], dtype=torch.float64), 4)
    expected = [0, 1, np.sin(0.5), np.cos(0.5), 0, 1, np.sin(-1), np.cos(-1), 0, 1, np.sin(1000), np.cos(1000)]
    np.testing.assert_allclose(encoded[0, 1].numpy(), [*expected, 0.001, -0.002, 2.0], atol=1e-12)


@pytest.mark.parametrize(
    ("frame", "max_side", "network"),
    [
        ((480, 854), 640, (360, 640)),
        ((1080, 1920), 640, (360, 640)),
        ((360, 640), 640, (360, 640)),
        ((854, 480), 320, (320, 176)),
        ((10, 700), 640, (32, 640)),
        ((1, 1), 640, (32, 32)),
    ],
)
def test_sides_are_capped_and_multiples_of_eight(frame, max_side, network):
    assert Resolution.capped(frame, max_side, 32).network == network


def test_points_come_back_from_the_networks_size():
    resolution = Resolution.capped((97, 211), 128, 32)
    points = np.random.default_rng(0).uniform(0, 90, (20, 2))
    np.testing.assert_allclose(resolution.to_frame(resolution.to_network(points)), points, atol=1e-12)
    np.testing.assert_allclose(resolution.to_network(np.array([-0.5, -0.5])), [-0.5, -0.5])
    np.testing.assert_allclose(resolution.to_network(np.array([210.5, 96.5])), [127.5, 55.5])


@pytest.mark.parametrize("max_side", [64, 128, 200])
def test_a_point_lies_on_the_same_content_at_the_networks_size(max_side):
    resolution = Resolution.capped((96, 128), max_side, 32)
    y, x = np.mgrid[:96, :128]
    centre = np.array([71.3, 40.6])
    blob = 250 * np.exp(-((x - centre[0]) ** 2 + (y - centre[1]) ** 2) / (2 * 6.0**2))
    seen = resolution.resize(np.repeat(np.round(blob).astype(np.uint8)[..., None], 3, axis=2))[..., 0].astype(float)
    y, x = np.mgrid[: seen.shape[0], : seen.shape[1]]
    centroid = np.array([(x * seen).sum(), (y * seen).sum()]) / seen.sum()
    np.testing.assert_allclose(centroid, resolution.to_network(centre), atol=0.02)
