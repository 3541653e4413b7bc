import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.grounding_dino import GroundingDinoParams
from moseg.tasks.detections import detect_objects
from moseg.tasks.networks.frame_tensor import frame_tensor
from moseg.tasks.networks.grounding_dino import compose_prompts

TAGS = ["person", "car", "dog", "ball"]
ANY = GroundingDinoParams(box_threshold=0, text_threshold=0, nms_iou=1, max_boxes=1000)


def assert_same(found, wanted):
    np.testing.assert_array_equal(found.boxes, wanted.boxes)
    np.testing.assert_array_equal(found.scores, wanted.scores)
    assert found.tags == wanted.tags


def test_a_few_distinct_boxes_are_found_in_any_frame(detector, frame):
    frames = {"flat": np.zeros_like(frame), "smooth": frame, "small": frame[:20, :24], "tall": np.rot90(frame)}
    for name, image in frames.items():
        found = detect_objects(detector, image, TAGS, GroundingDinoParams())
        assert 3 <= len(found.boxes) == len(found.scores) == len(found.tags) <= 10, name
        assert all(set(tag.split()) <= set(TAGS) for tag in found.tags)
        assert (np.diff(found.scores) <= 0).all() and (found.scores > 0.25).all()
        height, width = image.shape[:2]
        centres = (found.boxes[:, :2] + found.boxes[:, 2:]) / 2
        assert (centres > 0).all() and (centres < [width, height]).all()
        assert (found.boxes[:, 2:] - found.boxes[:, :2] >= 1).all()
        assert found.boxes.dtype == np.float32 and found.scores.dtype == np.float64


@torch.inference_mode()
def test_boxes_and_scores_are_the_networks_own(detector, frame):
    found = detect_objects(detector, frame, TAGS, ANY)
    (prompt,) = compose_prompts(detector.tokenizer, TAGS, 40, 256)
    pixels = frame_tensor(frame, detector.input_size(96, 128, 1.0), torch.device("cpu"))
    output = detector.model(pixel_values=pixels, input_ids=torch.tensor([prompt.token_ids]))
    logits = output.logits[0].numpy().astype(float)
    fits = 1 / (1 + np.exp(-logits[:, : len(prompt.token_ids)]))
    # Of any token, also of those that no name has.
    best = fits.max(axis=1)
    np.testing.assert_allclose(found.scores, np.sort(best)[::-1], rtol=1e-6)
    order = np.argsort(-best, kind="stable")
    x, y, width, height = output.pred_boxes[0].double().numpy()[order].T
    corners = np.stack([x - width / 2, y - height / 2, x + width / 2, y + height / 2], axis=1)
    np.testing.assert_allclose(found.boxes, corners * [128, 96, 128, 96], atol=1e-3)
    assert (found.boxes < 0).any(), "a box that is cut off is another prompt"
    named = detect_objects(detector, frame, TAGS, ANY.model_copy(update={"text_threshold": 0.5}))
    assert set(named.tags) - set(TAGS), "words of several names"
    assert named.tags == tuple(
        # A comma stands between two of them.
        " ".join(tag for tag, fits_it in zip(TAGS, fit[1:8:2], strict=True) if fits_it > 0.5)
        for fit in fits[order]
    )


def test_detection_is_repeatable(detector, frame):
    assert_same(*(detect_objects(detector, frame, TAGS, GroundingDinoParams()) for _ in range(2)))


def test_no_names_give_no_boxes(detector, frame):
    found = detect_objects(detector, frame, [], GroundingDinoParams())
    assert found.boxes.shape == (0, 4) and found.scores.shape == (0,) and found.tags == ()


def test_no_boxes_are_returned_if_none_passes_the_threshold(detector, frame):
    found = detect_objects(detector, frame, TAGS, GroundingDinoParams(box_threshold=1))
    assert found.boxes.shape == (0, 4) and found.tags == ()


def test_a_higher_box_threshold_only_removes_boxes(detector, frame):
    low, high = (
        detect_objects(detector, frame, TAGS, ANY.model_copy(update={"box_threshold": threshold}))
        for threshold in (0.3, 0.6)
    )
    assert (high.scores > 0.6).all()
    assert {tuple(box) for box in high.boxes.tolist()} < {tuple(box) for box in low.boxes.tolist()}


def test_the_text_threshold_removes_words_but_no_boxes(detector, frame):
    found = [
        detect_objects(detector, frame, TAGS, ANY.model_copy(update={"text_threshold": threshold}))
        for threshold in (0, 0.5, 1)
    ]
    for other in found[1:]:
        np.testing.assert_array_equal(other.boxes, found[0].boxes)
        np.testing.assert_array_equal(other.scores, found[0].scores)
    assert set(found[0].tags) == {" ".join(TAGS)}
    assert all(set(fewer.split()) <= set(TAGS) for fewer in found[1].tags)
    assert set(found[2].tags) == {""}


def test_boxes_of_all_prompts_compete(detector, frame):
    apart = detect_objects(detector, frame, TAGS, ANY.model_copy(update={"tags_per_prompt": 1}))
    assert len(apart.boxes) > len(detect_objects(detector, frame, TAGS, ANY).boxes)
    assert set(apart.tags) == set(TAGS)
    params = GroundingDinoParams(tags_per_prompt=1)
    assert len(detect_objects(detector, frame, TAGS, params).boxes) < len(apart.boxes)


def test_boxes_of_different_names_may_be_let_be(detector, frame):
    params = GroundingDinoParams(tags_per_prompt=1, nms_iou=0.1)
    among_all = detect_objects(detector, frame, TAGS, params)
    per_tag = detect_objects(detector, frame, TAGS, params.model_copy(update={"nms_per_tag": True}))
    assert len(per_tag.boxes) > len(among_all.boxes)


def test_the_best_boxes_are_kept(detector, frame):
    found = detect_objects(detector, frame, TAGS, GroundingDinoParams())
    fewer = detect_objects(detector, frame, TAGS, GroundingDinoParams(max_boxes=2))
    np.testing.assert_array_equal(fewer.boxes, found.boxes[:2])


def test_autocast_changes_nothing(detector, frame):
    plain = detect_objects(detector, frame, TAGS, GroundingDinoParams())
    with torch.autocast("cpu", dtype=torch.bfloat16):
        cast = detect_objects(detector, frame, TAGS, GroundingDinoParams())
    assert_same(cast, plain)


def test_a_frame_may_be_read_only(detector, frame):
    locked = frame.copy()
    locked.flags.writeable = False
    assert_same(
        detect_objects(detector, locked, TAGS, GroundingDinoParams()),
        detect_objects(detector, frame, TAGS, GroundingDinoParams()),
    )


@pytest.mark.parametrize("shape", [(96, 128), (96, 128, 4), (0, 128, 3), (5,)])
def test_an_image_that_is_not_an_rgb_frame_is_refused(detector, shape):
    with pytest.raises(InputError, match="not an RGB frame"):
        detect_objects(detector, np.zeros(shape, np.uint8), TAGS, GroundingDinoParams())


def test_a_detector_moves_as_a_whole(detector):
    moved = detector.to("cpu")
    assert moved.tokenizer is detector.tokenizer and moved.model.device.type == "cpu"
