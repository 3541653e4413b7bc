import numpy as np
import pytest
import torch

from moseg.tasks.networks.deaot import Deaot, DeaotConfig, LayerMemory, extend_memory
from moseg.tasks.networks.deaot.attention import neighbourhood

CONFIG = DeaotConfig(
    stem_width=8, stage_widths=(4, 8, 16), stage_depths=(2, 1, 1), d_model=32, num_layers=2, max_objects=3
)
HEIGHT, WIDTH = 65, 209  # 5 x 14 cells: wider than a window
# Logits of the last of four frames at every 8th row and 24th column, as the official network and engine give them with
# the same tensors in float64.
GOLDEN = [
    [
        [-0.222907421, -1.219917797, 0.060844373],
        [-1.542199925, -1.260979192, -0.848337664],
        [-1.048139172, -1.16302223, -1.672003588],
    ],
    [
        [0.04439075, 0.399517496, 0.01960034],
        [1.21206456, 0.300570899, 0.182811218],
        [1.120533968, 0.279554414, 0.605604426],
    ],
    [
        [0.201959956, -0.324650974, -0.113734171],
        [-0.033352667, 0.040463842, -0.416330244],
        [1.121152368, -0.138616022, 0.207851648],
    ],
    [
        [-0.308839837, -0.467929429, -0.515917579],
        [-1.476802675, -0.816122945, -0.507033168],
        [-1.283709048, -0.701589614, -0.930006808],
    ],
]


def random_deaot() -> Deaot:
    network = Deaot(CONFIG).double().eval().requires_grad_(False)
    rng = np.random.default_rng(0)
    for name, value in network.state_dict().items():
        noise = rng.standard_normal(tuple(value.shape))
        if value.ndim > 1:
            noise *= (2 / value[0].numel()) ** 0.5
        else:
            noise = 0.2 * noise + name.endswith(("weight", "running_var"))
        # The masks weigh more than the image, so that a wrong memory shows.
        if name.endswith("linear_ID_V.weight"):
            noise *= 5
        elif name.endswith("linear_QV.weight"):
            noise *= 2
        elif "adapter_" in name:
            noise *= 0.05
        value.copy_(torch.from_numpy(noise))
    return network


def random_video() -> tuple[torch.Tensor, torch.Tensor]:
    """Four frames (frame, 1, 3, y, x) and their labels 0 to 3 (frame, y, x), in blocks."""
    rng = np.random.default_rng(1)
    labels = np.kron(rng.integers(0, 4, (4, 5, 11)), np.ones((1, 13, 19), int))
    return torch.from_numpy(rng.standard_normal((4, 1, 3, HEIGHT, WIDTH))), torch.from_numpy(labels)


def logits_of(network: Deaot, images: torch.Tensor, labels: torch.Tensor) -> torch.Tensor:
    """Logits of the last frame, each frame's labels given once it was propagated; every other frame is remembered."""
    grid, dtype = network.grid(images.shape[-2:]), images.dtype
    masks = [(frame == torch.arange(1 + CONFIG.max_objects).view(-1, 1, 1)).to(dtype)[None] for frame in labels]
    short_term = long_term = network.memorize(network.encode(images[0]), masks[0], grid)
    for i in range(1, len(images)):
        logits, projected = network.propagate(network.encode(images[i]), long_term, short_term, grid)
        short_term = network.remember(projected, masks[i])
        if i % 2 == 0:
            long_term = [extend_memory(*pair, max_frames=10) for pair in zip(long_term, short_term, strict=True)]
    return logits


def test_logits_are_the_official_networks():
    logits = logits_of(random_deaot(), *random_video())
    assert logits.dtype == torch.float64 and logits.shape == (1, 4, 17, 53)
    np.testing.assert_allclose(logits[0, :, ::8, ::24], GOLDEN, atol=1e-6)


def test_attention_in_parts_gives_the_same_logits(monkeypatch):
    network, video = random_deaot(), random_video()
    whole = logits_of(network, *video)
    monkeypatch.setattr("moseg.tasks.networks.deaot.attention.MAX_SCORES", 1000)
    np.testing.assert_allclose(logits_of(network, *video), whole, atol=1e-9)


def test_a_remembered_frame_weighs_in():
    network, (images, labels) = random_deaot(), random_video()
    other = images.clone()
    other[1] = images[3]  # seen only in the memory of the frame after it
    assert (logits_of(network, other, labels) - logits_of(network, images, labels)).abs().max() > 0.01


def test_groups_side_by_side_are_tracked_as_each_alone():
    network, (images, labels) = random_deaot(), random_video()
    grid, frames = network.grid((HEIGHT, WIDTH)), [network.encode(image) for image in images]
    masks = (labels[:2, None] == torch.arange(4).view(1, -1, 1, 1)).double()

    def track(masks: torch.Tensor) -> torch.Tensor:
        memory = network.memorize(frames[0], masks, grid)
        return network.propagate(frames[1], memory, memory, grid)[0]

    both = track(masks)
    assert (both[0] - both[1]).abs().max() > 0.1
    for i in range(2):
        np.testing.assert_allclose(both[i], track(masks[i : i + 1])[0], atol=1e-9)


def test_under_autocast_logits_stay_in_float32_and_near(in_half_precision, relative_error):
    network, (images, labels) = random_deaot().float(), random_video()
    exact = logits_of(network, images.float(), labels)
    half = in_half_precision(lambda: logits_of(network, images.float(), labels))
    assert exact.dtype == half.dtype == torch.float32
    assert relative_error(half, exact) < 0.25


def test_short_term_propagation_is_limited_to_its_window():
    places, outside_mask = neighbourhood((3, 4), 1, torch.device("cpu"))
    corner, middle = 0, 1 * 4 + 2
    assert np.flatnonzero(~outside_mask[corner]).tolist() == [0, 1, 4, 5]
    assert places[corner, [0, 1, 4, 5]].tolist() == [4, 5, 7, 8]
    assert np.flatnonzero(~outside_mask[middle]).tolist() == [1, 2, 3, 5, 6, 7, 9, 10, 11]
    assert places[middle, [1, 2, 3, 5, 6, 7, 9, 10, 11]].tolist() == list(range(9))


@pytest.mark.parametrize(("max_frames", "kept"), [(1, [0]), (2, [0, 4]), (3, [0, 3, 4]), (9, [0, 1, 2, 3, 4])])
def test_memory_keeps_the_first_frame_and_the_newest(max_frames, kept):
    frames = [LayerMemory(*(torch.full((2, 3, width), float(i)) for width in (4, 5, 6))) for i in range(5)]
    memory = frames[0]
    for frame in frames[1:]:
        memory = extend_memory(memory, frame, max_frames)
    for values, width in zip(memory, (4, 5, 6), strict=True):
        assert values.shape == (2, 3 * len(kept), width)
        assert values[1, ::3, 0].tolist() == kept
