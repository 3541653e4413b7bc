import io

import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import DeaotParams
from moseg.tasks.networks import Checkpoint, unwrap_state
from moseg.tasks.networks.deaot import Deaot, build_deaot
from moseg.tasks.proposals.deaot import network_size, propagate_masks, track_masks_deaot
from moseg.workflows.weights.tiny.deaot import make_deaot

PARAMS = DeaotParams()
SIZE = (90, 122)


@pytest.fixture(scope="module")
def model() -> Deaot:
    tiny = make_deaot(0)
    tensors = unwrap_state(torch.load(io.BytesIO(tiny.files["model.pth"]), weights_only=True), "tiny")
    return build_deaot(Checkpoint("tiny", tensors, config=tiny.config))


def make_video(num_frames: int = 12, num_objects: int = 3, size=SIZE) -> tuple[list[np.ndarray], np.ndarray]:
    """Frames of coloured squares that creep to the right over noise, and their labels in the first one."""
    rng = np.random.default_rng(0)
    height, width = size
    side = int(0.6 * (height * width / num_objects) ** 0.5)
    across = max(width // (side + 12), 1)
    colours = rng.integers(0, 255, (num_objects, 3))
    frames, labels = rng.integers(90, 160, (num_frames, height, width, 3)).astype(np.uint8), np.zeros(size, np.uint16)
    for i in range(num_objects):
        top, left = (i // across) * (side + 8) + 4, (i % across) * (side + 12) + 4
        labels[top : top + side, left : left + side] = i + 1
        for t, frame in enumerate(frames):
            frame[top : top + side, left + t // 3 : left + t // 3 + side] = colours[i]
    return list(frames), labels


def overlap(masks0: np.ndarray, masks1: np.ndarray, label: int) -> float:
    return ((masks0 == label) & (masks1 == label)).sum() / ((masks0 == label) | (masks1 == label)).sum()


def test_objects_last_from_their_seeds_to_the_last_frame(model):
    frames, seeds = make_video()
    masks = track_masks_deaot(model, iter(frames), seeds, PARAMS)
    assert masks.dtype == np.uint16 and masks.shape == (12, *SIZE)
    assert (masks[0] == seeds).all()
    assert min(overlap(masks[-1], seeds, label) for label in (1, 2, 3)) > 0.4


def test_tracking_again_gives_the_same_masks_and_leaves_the_seeds_alone(model):
    frames, seeds = make_video()
    before = seeds.copy()
    assert (track_masks_deaot(model, frames, seeds, PARAMS) == track_masks_deaot(model, frames, seeds, PARAMS)).all()
    assert (seeds == before).all()


def test_more_objects_than_a_pass_holds_are_tracked_in_groups(model):
    frames, seeds = make_video(num_frames=6, num_objects=12, size=(160, 224))
    assert model.config.max_objects == 5
    masks = track_masks_deaot(model, frames, seeds, PARAMS)
    assert np.unique(masks[-1]).tolist() == list(range(13))
    assert np.mean([overlap(masks[-1], seeds, label) for label in range(1, 13)]) > 0.4


def test_the_background_of_several_groups_is_background_in_each(model):
    frames, seeds = make_video(num_frames=2, num_objects=7, size=(97, 129))
    raw = []
    hook = model.decoder.register_forward_hook(lambda _, __, output: raw.append(output))
    _, (_, merged) = propagate_masks(model, frames, seeds, PARAMS)
    hook.remove()
    (group0, group1) = raw[0].softmax(dim=1)[0], raw[0][:, :3].softmax(dim=1)[1]  # five objects, then two
    expected = torch.cat([group0[:1] * group1[:1], group0[1:], group1[1:]]).clamp(1e-5, 1 - 1e-5)
    # Corner cells lie on corner pixels: every fourth pixel is a cell of the decoder.
    np.testing.assert_allclose(merged.sigmoid()[:, ::4, ::4], expected, atol=1e-5)


def test_without_objects_masks_are_empty_and_the_network_is_not_run(model):
    calls = []
    hook = model.encoder.register_forward_hook(lambda *_: calls.append(True))
    masks = track_masks_deaot(model, make_video()[0], np.zeros(SIZE, np.uint16), PARAMS)
    hook.remove()
    assert masks.dtype == np.uint16 and masks.shape == (12, *SIZE)
    assert not masks.any() and not calls


@pytest.mark.parametrize("memory_frames", [1, 3, 100])
def test_memory_grows_up_to_its_bound(model, memory_frames):
    frames, seeds = make_video(num_frames=13)
    sizes = []
    hook = model.LSTT.register_forward_pre_hook(lambda _, inputs: sizes.append(inputs[1][0].keys.shape[1]))
    track_masks_deaot(model, frames, seeds, DeaotParams(memory_every=2, memory_frames=memory_frames))
    hook.remove()
    num_cells = 7 * 9
    assert [size / num_cells for size in sizes] == [min(1 + t // 2, memory_frames) for t in range(12)]


def test_a_longer_memory_changes_the_logits(model):
    frames, seeds = make_video(num_frames=8)
    last = [
        list(propagate_masks(model, frames, seeds, DeaotParams(memory_every=2, memory_frames=number)))[-1].logits
        for number in (1, 3, 100)
    ]
    assert not torch.equal(last[0], last[1]) and not torch.equal(last[1], last[2])


def test_large_frames_are_shrunk_for_the_network_and_labels_are_not(model):
    frames, seeds = make_video(num_frames=3, size=(180, 244))
    shown = []
    hook = model.encoder.register_forward_hook(lambda _, inputs, __: shown.append(tuple(inputs[0].shape)))
    masks = track_masks_deaot(model, frames, seeds, DeaotParams(max_side=122))
    hook.remove()
    assert shown == [(1, 3, 97, 129)] * 3
    assert masks.shape == (3, 180, 244)
    assert np.unique(masks[-1]).tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("size", "max_side", "expected"),
    [
        ((480, 854), 1040, (481, 849)),
        ((1080, 1920), 1040, (577, 1041)),
        ((1920, 1080), 1040, (1041, 577)),
        ((720, 1280), 624, (353, 625)),
        ((96, 128), 1040, (97, 129)),
        ((97, 129), 1040, (97, 129)),
    ],
)
def test_frames_are_shown_at_the_size_of_the_official_evaluation(size, max_side, expected):
    assert network_size(size, max_side) == expected


def test_even_the_smallest_frame_has_two_cells_a_side(model):
    assert network_size((1, 5), 1040) == (17, 17)
    seeds = np.ones((1, 5), np.uint16)
    assert track_masks_deaot(model, [np.zeros((1, 5, 3), np.uint8)] * 2, seeds, PARAMS).shape == (2, 1, 5)


def test_under_autocast_logits_stay_in_float32_and_near(model, in_half_precision, relative_error):
    frames, seeds = make_video(num_frames=4, num_objects=7)
    exact = list(propagate_masks(model, frames, seeds, PARAMS))
    half = in_half_precision(lambda: list(propagate_masks(model, frames, seeds, PARAMS)))
    assert all(frame.logits.dtype == torch.float32 for frame in half[1:])
    assert relative_error(half[1].logits, exact[1].logits) < 0.25
    assert all(frame.labels.dtype == np.uint16 for frame in half)
    assert np.unique(half[-1].labels).tolist() == list(range(8))


def test_invalid_frames_or_labels_are_refused(model):
    frames, seeds = make_video(num_frames=2)
    with pytest.raises(InputError, match=r"seeds.*int32"):
        track_masks_deaot(model, frames, seeds.astype(np.int32), PARAMS)
    with pytest.raises(InputError, match=r"frame 1.*\(90, 121, 3\).*\(90, 122, 3\)"):
        track_masks_deaot(model, [frames[0], frames[1][:, 1:]], seeds, PARAMS)
    with pytest.raises(InputError, match=r"frame 0.*float32"):
        track_masks_deaot(model, [frames[0].astype(np.float32)], seeds, PARAMS)
    with pytest.raises(InputError, match="no frames"):
        track_masks_deaot(model, [], seeds, PARAMS)
