import numpy as np
import pytest
import torch

from moseg.schemas.parameters import VideoNetworkParams
from moseg.tasks.video_network import IGNORED, MOVING, STATIC
from moseg.tasks.video_network.crops import draw_crop, lab_bytes, network_input
from moseg.tasks.video_network.network import build_network, infer_logits, pack_weights, restore_network
from moseg.tasks.video_network.training import train_network

SHAPE = (45, 61)
PARAMS = VideoNetworkParams(steps=30, crops=2, crop_height=32, crop_width=48, learning_rate=1e-2)


@pytest.fixture(scope="module")
def clip() -> tuple[np.ndarray, np.ndarray]:
    """Return six frames of a red disc on grey texture, as Lab bytes, and where the disc is."""
    rng = np.random.default_rng(0)
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]]
    frames, truth = [], []
    for t in range(6):
        disc = (y - 22) ** 2 + (x - 18 - 4 * t) ** 2 < 100
        image = np.repeat(rng.integers(90, 150, (*SHAPE, 1)), 3, axis=2)
        image[disc] = np.array((160, 60, 60)) + rng.integers(-20, 20, (int(disc.sum()), 3))
        frames.append(lab_bytes(image.astype(np.uint8)))
        truth.append(disc)
    return np.stack(frames), np.stack(truth)


@pytest.fixture(scope="module")
def half_labels(clip) -> np.ndarray:
    """Return labels that say nothing about the lower half of the disc."""
    labels = np.where(clip[1], MOVING, STATIC).astype(np.uint8)
    labels[:, 23:][clip[1][:, 23:]] = IGNORED
    return labels


@pytest.fixture(scope="module")
def trained(clip, half_labels):
    return train_network(clip[0], half_labels, np.random.default_rng(1), PARAMS)


def test_the_network_finds_the_half_of_the_object_that_was_not_labelled(clip, half_labels, trained):
    lab, truth = clip
    start = build_network(np.random.default_rng(1)).eval()
    agreement = [
        np.mean([((infer_logits(network, frame) > 0) == disc).mean() for frame, disc in zip(lab, truth, strict=True)])
        for network in (start, trained)
    ]
    assert agreement[1] > 0.95 and agreement[1] > agreement[0]
    found = np.stack([infer_logits(trained, frame) > 0 for frame in lab])
    assert found[truth].mean() > 0.8 > (half_labels == MOVING)[truth].mean() + 0.2


def test_the_same_seed_gives_the_same_weights_and_another_one_does_not(clip, half_labels):
    params = PARAMS.model_copy(update={"steps": 3})
    first, second, other = (
        pack_weights(train_network(clip[0], half_labels, np.random.default_rng(seed), params)) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first, second)
    assert not np.array_equal(first, other)


def test_restored_weights_give_the_same_logits(clip, trained):
    weights = pack_weights(trained)
    assert weights.dtype == np.float32 and weights.ndim == 1 and np.isfinite(weights).all()
    np.testing.assert_array_equal(infer_logits(restore_network(weights), clip[0][0]), infer_logits(trained, clip[0][0]))


def test_training_leaves_the_settings_of_torch_as_they_were(clip, half_labels):
    before = torch.get_num_threads(), torch.are_deterministic_algorithms_enabled()
    state = torch.random.get_rng_state()
    train_network(clip[0], half_labels, np.random.default_rng(0), PARAMS.model_copy(update={"steps": 1}))
    assert (torch.get_num_threads(), torch.are_deterministic_algorithms_enabled()) == before
    assert torch.equal(torch.random.get_rng_state(), state)


def test_a_crop_shows_colours_and_labels_of_the_same_place():
    lab = np.zeros((1, *SHAPE, 3), np.uint8)
    labels = np.full((1, *SHAPE), STATIC, np.uint8)
    lab[0, 10:35, 15:45, 0] = 255
    labels[0, 10:35, 15:45] = MOVING
    plain = PARAMS.model_copy(update={"colour_gain": 0, "colour_shift": 0, "max_noise": 0})
    for seed in range(8):
        crop = draw_crop(lab, labels, np.random.default_rng(seed), plain)
        assert crop.colours.shape == (32, 48, 3) and crop.colours.dtype == np.float32
        bright = crop.colours[..., 0] > 0
        assert (bright == (crop.labels == MOVING)).mean() > 0.95


def test_grey_of_middle_lightness_is_nought():
    np.testing.assert_array_equal(network_input(np.full((2, 2, 3), 128, np.uint8)), 0)
