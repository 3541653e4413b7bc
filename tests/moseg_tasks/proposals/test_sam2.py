import numpy as np
import pytest
import torch
from safetensors.torch import load
from transformers import Sam2VideoModel

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.sam2 import Sam2Params
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.frame_tensor import frame_tensor
from moseg.tasks.networks.sam2 import build_sam2_video, forget_past, start_sessions
from moseg.tasks.proposals.sam2 import track_masks_sam2
from moseg.workflows.weights.tiny.sam2 import make_sam2

PARAMS = Sam2Params()
SIZE = (96, 128)


def build_tiny():
    files = make_sam2(0).files
    return build_sam2_video(
        Checkpoint("tiny", load(files["model.safetensors"]), {"config.json": files["config.json"].decode()})
    )


@pytest.fixture(scope="module")
def model():
    return build_tiny()


@pytest.fixture
def seeds():
    seeds = np.zeros(SIZE, np.uint16)
    seeds[20:50, 20:60] = 1
    seeds[50:80, 80:112] = 2
    seeds[60:90, 8:48] = 3
    return seeds


def watch(num_frames):
    """Frames of noise that drifts."""
    noise = np.random.default_rng(0).integers(0, 256, (*SIZE, 3), np.uint8)
    return [np.roll(noise, frame, axis=1) for frame in range(num_frames)]


def iou(masks, seeds, label):
    return np.count_nonzero((masks == label) & (seeds == label)) / np.count_nonzero((masks == label) | (seeds == label))


def test_first_frame_has_the_seeds(model, seeds):
    masks = track_masks_sam2(model, watch(2), seeds, PARAMS)
    assert (masks.dtype, masks.shape) == (np.uint16, (2, *SIZE))
    np.testing.assert_array_equal(masks[0], seeds)


def test_under_autocast_to_float16_objects_keep_their_labels(model, seeds):
    # The memory of masks is in bfloat16, which autocast to another type refuses to join with the objects' pointers.
    with torch.autocast("cpu", dtype=torch.float16):
        masks = track_masks_sam2(model, watch(3), seeds, PARAMS)
    for label in (1, 2, 3):
        assert iou(masks[-1], seeds, label) > 0.6


def test_objects_keep_their_labels(model, seeds):
    masks = track_masks_sam2(model, watch(12), seeds, PARAMS)
    for label in (1, 2, 3):
        assert iou(masks[1], seeds, label) > 0.6
        assert iou(masks[-1], seeds, label) > 0.6


def test_labels_may_have_gaps(model, seeds):
    sparse = np.where(seeds == 2, 7, np.where(seeds == 3, 0, seeds)).astype(np.uint16)
    masks = track_masks_sam2(model, watch(3), sparse, PARAMS)
    assert set(np.unique(masks[-1])) == {0, 1, 7}


def test_no_seeds_give_no_labels(model):
    masks = track_masks_sam2(model, watch(3), np.zeros(SIZE, np.uint16), PARAMS)
    assert masks.shape == (3, *SIZE)
    assert not masks.any()


def test_labels_do_not_depend_on_how_many_go_in_one_pass(model, seeds):
    together = track_masks_sam2(model, watch(5), seeds, PARAMS)
    alone = track_masks_sam2(model, watch(5), seeds, Sam2Params(objects_per_pass=1))
    # Sums come out in another order.
    assert (together == alone).mean() > 0.99


def test_a_pixel_goes_to_the_object_that_is_surest(model, seeds, monkeypatch):
    # Both objects are followed over the whole frame; the second is surer in its right half.
    def see_both(session, frame, frame_idx):
        class Found:
            object_ids = (1, 2)
            pred_masks = torch.ones(2, 1, 32, 32)

        Found.pred_masks[1, :, :, :16] = -2
        Found.pred_masks[1, :, :, 16:] = 3
        session.processed_frames = {}
        return Found

    monkeypatch.setattr(model, "forward", see_both)
    masks = track_masks_sam2(model, watch(2), np.where(seeds == 3, 0, seeds).astype(np.uint16), PARAMS)
    assert (masks[1, :, :60] == 1).all()
    assert (masks[1, :, 68:] == 2).all()


def test_forgetting_changes_no_answer(seeds):
    model = build_tiny()
    # It looks at all of its memory alike, pointers included.
    model.memory_attention.layers[0].cross_attn_image.q_proj.bias.zero_()
    (bounded,), (unbounded,) = start_sessions(model, seeds, 8), start_sessions(model, seeds, 8)
    for index, frame in enumerate(watch(20)):
        pixels = frame_tensor(frame, (128, 128), model.device)
        answers = [model(session, frame=pixels, frame_idx=index).pred_masks for session in (bounded, unbounded)]
        assert torch.equal(*answers)
        forget_past(bounded, index, model.config.num_maskmem - 1, PARAMS.memory_reach)


def test_memory_does_not_grow_with_the_video(model, seeds):
    (session,) = start_sessions(model, seeds, 8)
    held = []
    for index, frame in enumerate(watch(24)):
        model(session, frame=frame_tensor(frame, (128, 128), model.device), frame_idx=index)
        forget_past(session, index, 6, 8)
        held.append(count_values(vars(session)))
    assert held[9:] == held[9:10] * 15
    assert held[9] < 12 * held[0]


def count_values(held):
    """Numbers and entries in nested containers of tensors."""
    if isinstance(held, torch.Tensor):
        return held.numel()
    if isinstance(held, dict):
        return len(held) + sum(map(count_values, held.values()))
    if isinstance(held, list | tuple):
        return len(held) + sum(map(count_values, held))
    return 0


def test_a_shorter_memory_still_follows(model, seeds):
    masks = track_masks_sam2(model, watch(6), seeds, Sam2Params(memory_reach=1))
    assert iou(masks[-1], seeds, 1) > 0.6


def test_objects_keep_their_labels_in_half_precision(model, seeds, in_half_precision):
    masks = in_half_precision(lambda: track_masks_sam2(model, watch(4), seeds, PARAMS))
    assert (masks.dtype, masks.shape) == (np.uint16, (4, *SIZE))
    np.testing.assert_array_equal(masks[0], seeds)
    for label in (1, 2, 3):
        overlaps = [iou(masks[-1] == label, seeds == other, True) for other in (1, 2, 3)]
        assert np.argmax(overlaps) == label - 1


def test_half_precision_is_near_full(model, seeds, in_half_precision):
    def logits():
        outputs = []
        with model.register_forward_hook(lambda _module, _inputs, output: outputs.append(output.pred_masks)):
            track_masks_sam2(model, watch(2), seeds, PARAMS)
        return outputs[1].float().numpy()

    # The memory of a random network enlarges roundings, on some processors to a third of the logits' spread.
    half, full = in_half_precision(logits), logits()
    for found, exact in zip(half, full, strict=True):
        assert np.corrcoef(found.ravel(), exact.ravel())[0, 1] > 0.6


def test_frames_are_read_one_by_one(model, seeds):
    read = []

    def show():
        for index, frame in enumerate(watch(3)):
            read.append(index)
            yield frame
        raise ConnectionError

    with pytest.raises(ConnectionError):
        track_masks_sam2(model, show(), seeds, PARAMS)
    assert read == [0, 1, 2]


def test_a_frame_of_another_size_is_named(model, seeds):
    with pytest.raises(InputError, match=r"not an RGB frame in frame 1; got uint8 \(95, 128, 3\)"):
        track_masks_sam2(model, [watch(1)[0], watch(1)[0][1:]], seeds, PARAMS)


def test_no_frames_are_refused(model, seeds):
    with pytest.raises(InputError, match="no frames to track in"):
        track_masks_sam2(model, [], seeds, PARAMS)


def test_seeds_that_are_no_labels_are_refused(model, seeds):
    with pytest.raises(InputError, match="not labels in seeds"):
        track_masks_sam2(model, watch(1), seeds.astype(np.int64), PARAMS)


def test_a_given_mask_is_remembered_as_the_authors_do(model, seeds, monkeypatch):
    """By its single-mask pointer, and at a quarter of the network's side: transformers does neither."""
    asked, remembered = [], []
    frame, memory = Sam2VideoModel._single_frame_forward, Sam2VideoModel._encode_new_memory

    def spy_frame(self, *args, **kwargs):
        asked.append(kwargs)
        return frame(self, *args, **kwargs)

    def spy_memory(self, *args, **kwargs):
        remembered.append(kwargs["pred_masks_high_res"])
        return memory(self, *args, **kwargs)

    monkeypatch.setattr(Sam2VideoModel, "_single_frame_forward", spy_frame)
    monkeypatch.setattr(Sam2VideoModel, "_encode_new_memory", spy_memory)
    track_masks_sam2(model, watch(1), seeds, PARAMS)
    assert asked and all(kwargs["multimask_output"] is False for kwargs in asked)
    for mask in remembered:
        assert len(mask.unique()) > 2, "a mask as given has two values"
