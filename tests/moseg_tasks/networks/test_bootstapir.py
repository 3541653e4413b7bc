import hashlib

import cv2
import numpy as np
import pytest
import torch
import torch.nn.functional as F

from moseg.schemas.errors import InputError
from moseg.tasks.networks.bootstapir import BootsTapir, BootsTapirConfig, build_bootstapir
from moseg.tasks.networks.bootstapir.matching import soft_argmax
from moseg.tasks.networks.bootstapir.mixer import Mixer
from moseg.tasks.networks.bootstapir.model import refined_sides
from moseg.tasks.networks.checkpoint import Checkpoint

SIZES = {
    "widths": [4, 6, 8, 10],
    "extra_blocks": 2,
    "extra_expansion": 2,
    "hidden": 12,
    "depth": 2,
    "matching_side": 64,
}
STATE_DICT_DIGEST = "c37d6ce03911ec054f13cd905e5fdd9efbf8897338ee3e0ab8736672962e9966"
SIDE, NUM_FRAMES, NUM_POINTS = 96, 5, 6
MOVE_SCALE = 0.1
"""Factor of the rows of the last layer that move points."""
GOLDEN_POINTS = [
    [[86.935473337, 26.644847357], [84.289579656, 27.198476324]],
    [[86.877949131, 61.174441453], [86.659048594, 89.018291587]],
]
GOLDEN_OCCLUSION = [[-2.163658148, -2.775091492], [-2.279504028, -2.529254231]]


def seeded_tensors(seed=0):
    """A state dict that does not depend on torch's generators, with signals of about unit size in each layer."""
    rng = np.random.default_rng(seed)
    with torch.device("meta"):
        shapes = {name: tuple(v.shape) for name, v in BootsTapir(BootsTapirConfig(**SIZES)).state_dict().items()}
    tensors = {}
    for name, shape in shapes.items():
        noise = torch.from_numpy(rng.standard_normal(shape) / np.sqrt(max(np.prod(shape[1:]), 4)))
        tensors[name] = noise + 1 if len(shape) == 1 and name.endswith("weight") else noise
    tensors["torch_pips_mixer.linear_1.weight"][:2] *= MOVE_SCALE
    return tensors


@pytest.fixture
def network():
    return build_bootstapir(Checkpoint("tiny", seeded_tensors(), config=SIZES)).double()


@pytest.fixture
def images():
    noise = np.random.default_rng(1).integers(0, 256, (NUM_FRAMES, 12, 12, 3), dtype=np.uint8)
    frames = [cv2.resize(image, (SIDE, SIDE), interpolation=cv2.INTER_CUBIC) for image in noise]
    return torch.from_numpy(np.stack(frames))


@pytest.fixture
def points():
    return torch.from_numpy(np.random.default_rng(2).uniform(4, SIDE - 4, (NUM_POINTS, 2)))


@torch.inference_mode()
def follow(network, images, points, frame=1, iterations=2):
    grids = network.encode(images)
    return network(grids, points, frame, network.appearances(grids, frame, points), iterations)


def test_names_and_shapes_are_those_of_the_published_state_dict():
    with torch.device("meta"):
        tensors = BootsTapir(BootsTapirConfig()).state_dict()
    lines = "\n".join(sorted(f"{name} {tuple(value.shape)}" for name, value in tensors.items()))
    assert len(tensors) == 218
    assert sum(value.numel() for value in tensors.values()) == 54_699_335
    assert hashlib.sha256(lines.encode()).hexdigest() == STATE_DICT_DIGEST


def test_outputs_of_a_seeded_network_do_not_change(network, images, points):
    result = follow(network, images, points)
    np.testing.assert_allclose(result.points[:2, [0, 4]].numpy(), GOLDEN_POINTS, atol=1e-6)
    np.testing.assert_allclose(result.occlusion[:2, [0, 4]].numpy(), GOLDEN_OCCLUSION, atol=1e-6)


def test_a_network_is_built_to_be_run(network):
    built = build_bootstapir(Checkpoint("half", {k: v.half() for k, v in seeded_tensors().items()}, config=SIZES))
    assert not built.training
    assert all(p.dtype == torch.float32 and not p.requires_grad and p.device.type == "cpu" for p in built.parameters())
    assert network.dtype == torch.float64


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda tensors: tensors.pop("torch_pips_mixer.linear.bias"),
            "tensors are missing in weights tiny; got torch_pips_mixer.linear.bias",
        ),
        (lambda tensors: tensors.update(extra=torch.zeros(1)), "not the network's in weights tiny; got extra"),
        (
            lambda tensors: tensors.update({"extra_convs.blocks.0.conv.bias": torch.zeros(3)}),
            r"extra_convs.blocks.0.conv.bias \(3,\) instead of \(20,\)",
        ),
    ],
)
def test_a_state_dict_that_is_not_the_networks_is_refused(change, message):
    tensors = seeded_tensors()
    change(tensors)
    with pytest.raises(InputError, match=message):
        build_bootstapir(Checkpoint("tiny", tensors, config=SIZES))


def test_without_extra_convolutions_it_reads_tapirs_state_dict():
    tensors = {name: value for name, value in seeded_tensors().items() if not name.startswith("extra_convs")}
    build_bootstapir(Checkpoint("tapir", tensors, config=SIZES | {"extra_blocks": 0}))


def test_sizes_that_the_network_cannot_have_are_an_input_error():
    with pytest.raises(InputError, match="invalid sizes in config of weights tiny; got matching_side"):
        build_bootstapir(Checkpoint("tiny", seeded_tensors(), config=SIZES | {"matching_side": 63}))


def test_points_are_followed_each_for_itself(network, images, points):
    together = follow(network, images, points)
    order = torch.tensor([3, 0, 4])
    fewer = follow(network, images, points[order])
    for some, every in zip(fewer, together, strict=True):
        torch.testing.assert_close(some, every[order])


def test_frames_are_encoded_each_for_itself_at_each_size(network, images):
    with torch.inference_mode():
        together, alone = network.encode(images), network.encode(images[3:4])
    assert [grid.side for grid in together] == [64, 96]
    for grid, single in zip(together, alone, strict=True):
        for level, maps in zip(grid.levels, single.levels, strict=True):
            torch.testing.assert_close(level[3:4], maps)
    shapes = [[tuple(level.shape) for level in grid.levels] for grid in together]
    assert shapes == [
        [(5, 16, 16, 6), (5, 8, 8, 10), (5, 4, 4, 10)],
        [(5, 24, 24, 6), (5, 12, 12, 10), (5, 6, 6, 10)],
    ]


def test_maps_have_unit_length(network, images):
    with torch.inference_mode():
        fine, coarse, _ = network.encode(images)[1].levels
    for level in (fine, coarse):
        torch.testing.assert_close(level.norm(dim=-1), torch.ones(level.shape[:3], dtype=torch.float64))


def test_a_point_changes_by_frames_that_lie_after_it_and_before_it(network, images, points):
    """Unlike an online tracker, the network sees all frames at once."""
    before = follow(network, images, points, frame=2)
    for changed, seen in ((4, 0), (0, 4)):
        other = images.clone()
        other[changed] = 255 - other[changed]
        after = follow(network, other, points, frame=2)
        assert (after.points[:, seen] - before.points[:, seen]).abs().max() > 1e-6


def test_half_precision_gives_maps_in_full_precision_that_are_near(network, images, in_half_precision, relative_error):
    network = network.float()
    with torch.inference_mode():
        exact = [level for grid in network.encode(images) for level in grid.levels]
        found = in_half_precision(lambda: [level for grid in network.encode(images) for level in grid.levels])
    assert {level.dtype for level in found} == {torch.float32}
    assert all(relative_error(*levels) < 0.25 for levels in zip(found, exact, strict=True))


@torch.inference_mode()
def test_half_precision_follows_points_through_equal_maps_near_to_where_full_precision_does(
    network, images, points, in_half_precision, relative_error
):
    """On other maps, however near, the most similar place of two that are about equal can be the other one."""
    network, points = network.float(), points.float()
    grids = network.encode(images)
    appearances = network.appearances(grids, 1, points)
    exact = network(grids, points, 1, appearances, 2)
    found = in_half_precision(lambda: network(grids, points, 1, appearances, 2))
    assert {values.dtype for values in found} == {torch.float32}
    assert all(relative_error(*values) < 0.25 for values in zip(found, exact, strict=True))


def test_two_runs_are_equal_to_the_bit(network, images, points):
    for first, second in zip(*(follow(network, images, points) for _ in range(2)), strict=True):
        assert torch.equal(first, second)


@pytest.mark.parametrize(("first", "last"), [(56, 488), (88, 120), (88, 240), (256, 2040)])
def test_the_last_side_is_that_of_the_frame(first, last):
    assert refined_sides(first, last)[-1] == last


@pytest.mark.parametrize(
    ("last", "sides"),
    [(256, (256,)), (264, (256, 264)), (512, (256, 512)), (640, (256, 400, 640)), (1024, (256, 512, 1024))],
)
def test_sides_grow_in_even_factors_of_at_most_two(last, sides):
    assert refined_sides(256, last) == sides


def test_the_maximum_of_a_heat_map_is_located_between_cells():
    heat = torch.zeros(2, 16, 24, dtype=torch.float64)
    heat[0, 5, 7] = heat[0, 5, 8] = 2
    heat[1, 10, 3] = 2
    heat[1, 1, 20] = 1.9
    expected = torch.tensor([[8.0 / 24, 5.5 / 16], [3.5 / 24, 10.5 / 16]], dtype=torch.float64)
    torch.testing.assert_close(soft_argmax(heat), expected, atol=1e-6, rtol=0)


def test_frames_are_mixed_by_the_published_layers():
    """Ours sums the hidden channels of a channel within one convolution."""
    torch.manual_seed(0)
    block = Mixer(BootsTapirConfig(**SIZES)).double().blocks[0]
    x = torch.randn(3, 7, 12, dtype=torch.float64)
    with torch.inference_mode():
        hidden = F.gelu(block.mlp1_up(x.transpose(1, 2)), approximate="tanh")
        expected = block.mlp1_up_1(hidden).view(3, 12, 4, 7).sum(dim=2).transpose(1, 2)
        torch.testing.assert_close(block._mix_frames(x), expected)
