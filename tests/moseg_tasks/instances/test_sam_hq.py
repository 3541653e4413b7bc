import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.sam_hq import SamHqParams
from moseg.tasks.instances.sam_hq import segment_boxes_sam_hq
from moseg.tasks.networks.sam_hq import decode_boxes

BOXES = np.array([[8, 8, 60, 70], [50, 30, 120, 90], [90, 5, 125, 40]], np.float32)


def fill(box, size):
    mask = np.zeros(size, bool)
    left, top, right, bottom = np.round(box).astype(int)
    mask[top:bottom, left:right] = True
    return mask


@pytest.mark.parametrize("size", [(96, 128), (192, 256), (128, 96), (100, 333)])
def test_masks_lie_where_their_boxes_do(sam_hq, size):
    boxes = BOXES * np.tile([size[1] / 128, size[0] / 96], 2)
    noise = np.random.default_rng(0).integers(0, 256, (*size, 3), dtype=np.uint8)
    masks, quality = segment_boxes_sam_hq(sam_hq, noise, boxes, SamHqParams())
    assert masks.shape == (3, *size) and masks.dtype == bool
    assert quality.shape == (3,) and quality.dtype == np.float64 and np.isfinite(quality).all()
    for mask, box in zip(masks, boxes, strict=True):
        filled = fill(box, size)
        assert (mask & filled).sum() > 0.4 * (mask | filled).sum()


def test_masks_do_not_depend_on_how_many_are_decoded_together(sam_hq, frame):
    together, quality = segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams())
    apart, quality_apart = segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams(boxes_per_pass=1))
    assert (together != apart).mean() < 1e-3
    np.testing.assert_allclose(quality_apart, quality, atol=1e-5)


def test_the_image_is_encoded_once(sam_hq, frame, monkeypatch):
    seen = []
    encode = sam_hq.get_image_embeddings
    monkeypatch.setattr(sam_hq, "get_image_embeddings", lambda pixels: seen.append(pixels) or encode(pixels))
    segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams(boxes_per_pass=1))
    assert [tuple(pixels.shape) for pixels in seen] == [(1, 3, 128, 128)]
    assert not seen[0][..., 96:, :].any()  # padded below


def test_masks_look_at_the_frame(sam_hq, frame):
    masks, _ = segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams())
    others, _ = segment_boxes_sam_hq(sam_hq, 255 - frame, BOXES, SamHqParams())
    assert (masks != others).any(axis=(1, 2)).all()


def test_the_high_quality_token_alone_makes_other_masks(sam_hq, frame):
    masks, _ = segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams())
    alone, _ = segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams(hq_token_only=True))
    assert (masks != alone).mean() > 0.05


def test_without_boxes_there_are_no_masks(sam_hq, frame):
    masks, quality = segment_boxes_sam_hq(sam_hq, frame, np.zeros((0, 4), np.float32), SamHqParams())
    assert masks.shape == (0, 96, 128) and quality.shape == (0,)


def test_masks_are_repeatable(sam_hq, frame):
    (first, _), (second, _) = (segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams()) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_half_precision_changes_little(sam_hq, frame, monkeypatch, in_half_precision, relative_error):
    logits = []

    def watch_decoder(*args):
        found = decode_boxes(*args)
        logits.append(found[0])
        return found

    monkeypatch.setattr("moseg.tasks.instances.sam_hq.decode_boxes", watch_decoder)
    segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams())
    masks, quality = in_half_precision(lambda: segment_boxes_sam_hq(sam_hq, frame, BOXES, SamHqParams()))
    assert masks.dtype == bool and masks.shape == (3, 96, 128)
    assert quality.dtype == np.float64 and np.isfinite(quality).all()
    # The decoder works in single precision.
    assert logits[1].dtype == torch.float32
    assert relative_error(logits[1], logits[0]) < 0.25


@pytest.mark.parametrize("boxes", [[0, 0, 1, 1], [[5, 5, 4, 8]], [[0, 0, np.nan, 5]], [[1, 2, 3]]])
def test_invalid_boxes_are_refused(sam_hq, frame, boxes):
    with pytest.raises(InputError, match="not boxes"):
        segment_boxes_sam_hq(sam_hq, frame, np.array(boxes, float), SamHqParams())


def test_an_image_that_is_not_an_rgb_frame_is_refused(sam_hq, frame):
    with pytest.raises(InputError, match="not an RGB frame"):
        segment_boxes_sam_hq(sam_hq, frame[..., 0], BOXES, SamHqParams())
