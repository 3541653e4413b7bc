import hashlib
import re

import numpy as np
import pytest
import torch
from safetensors.torch import load
from torch.nn import functional
from transformers import Sam2Config, Sam2Model, Sam2VideoConfig, Sam2VideoModel

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.sam2 import Sam2Params
from moseg.tasks.instances.sam2 import segment_boxes_sam2, segment_prompts_sam2
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.frame_tensor import Resizing, frame_tensor
from moseg.tasks.networks.sam2 import build_sam2_image, build_sam2_video
from moseg.workflows.weights.tiny.sam2 import make_sam2

PARAMS = Sam2Params()
BOXES = np.array([[20, 20, 60, 50], [80, 50, 110, 80], [0, 0, 30, 30], [5, 40, 100, 95]], np.float32)
# Width of the first stage, its heads, blocks, global attention, background of the encoding of places, windows.
PUBLISHED = {
    "tiny": (96, 1, [1, 2, 7, 2], [5, 7, 9], [7, 7], [8, 4, 14, 7]),
    "small": (96, 1, [1, 2, 11, 2], [7, 10, 13], [7, 7], [8, 4, 14, 7]),
    "base-plus": (112, 2, [2, 3, 16, 3], [12, 16, 20], [14, 14], [8, 4, 14, 7]),
    "large": (144, 2, [2, 6, 36, 4], [23, 33, 43], [7, 7], [8, 4, 16, 8]),
}


@pytest.fixture(scope="module")
def checkpoint():
    files = make_sam2(0).files
    return Checkpoint("tiny", load(files["model.safetensors"]), {"config.json": files["config.json"].decode()})


@pytest.fixture(scope="module")
def model(checkpoint):
    return build_sam2_image(checkpoint)


@pytest.fixture
def image():
    return np.random.default_rng(0).integers(0, 256, (96, 128, 3), np.uint8)


def fill_box(box, size=(96, 128)):
    y, x = np.mgrid[: size[0], : size[1]]
    return (x >= box[0]) & (x < box[2]) & (y >= box[1]) & (y < box[3])


def iou(mask0, mask1):
    return np.count_nonzero(mask0 & mask1) / np.count_nonzero(mask0 | mask1)


@pytest.mark.parametrize(
    ("size", "tensors", "parameters"),
    [
        ("tiny", 469, 38_963_010),
        ("small", 517, 46_060_866),
        ("base-plus", 613, 80_850_690),
        ("large", 901, 224_447_154),
    ],
)
def test_published_network_has_its_size(size, tensors, parameters):
    width, heads, blocks, global_blocks, background, windows = PUBLISHED[size]
    widths = [width, 2 * width, 4 * width, 8 * width]
    vision = {
        "model_type": "sam2_vision_model",
        "backbone_channel_list": widths[::-1],
        "backbone_config": {
            "model_type": "sam2_hiera_det_model",
            "hidden_size": width,
            "blocks_per_stage": blocks,
            "embed_dim_per_stage": widths,
            "num_attention_heads_per_stage": [heads, 2 * heads, 4 * heads, 8 * heads],
            "window_size_per_stage": windows,
            "global_attention_blocks": global_blocks,
            "window_positional_embedding_background_size": background,
        },
    }
    with torch.device("meta"):
        video = Sam2VideoModel(Sam2VideoConfig.from_dict({"vision_config": vision})).state_dict()
        image = Sam2Model(Sam2Config.from_dict({"model_type": "sam2_video", "vision_config": vision})).state_dict()
    assert (len(video), sum(tensor.numel() for tensor in video.values())) == (tensors, parameters)
    assert len(video) - len(image) == 160
    assert {name: tensor.shape for name, tensor in image.items()}.items() <= {
        name: tensor.shape for name, tensor in video.items()
    }.items()


def test_tiny_checkpoint_has_the_published_names(checkpoint):
    lines = sorted(f"{name} {tuple(tensor.shape)}" for name, tensor in checkpoint.tensors.items())
    assert hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16] == "f2859c924e5a3f2e"


@pytest.mark.parametrize("build", [build_sam2_image, build_sam2_video])
def test_network_is_ready_for_inference(build, checkpoint):
    model = build(checkpoint)
    assert not model.training
    assert {tensor.dtype for tensor in model.parameters()} == {torch.float32}
    assert not any(tensor.requires_grad for tensor in model.parameters())


def test_output_of_a_seeded_network_does_not_change(checkpoint):
    ramp = torch.linspace(-1, 1, 3 * 128 * 128, dtype=torch.float64).view(1, 3, 128, 128)
    box = torch.tensor([[[30.0, 20.0, 90.0, 70.0]]], dtype=torch.float64)
    with torch.inference_mode():
        answer = build_sam2_image(checkpoint).double()(ramp, input_boxes=box, multimask_output=False)
    golden = torch.tensor([-6.1980698, -4.3315164, 9.2242136, 9.3853372, -5.9214866, -5.8331086], dtype=torch.float64)
    # Places are encoded in float32, whose sines differ by CPU.
    torch.testing.assert_close(answer.pred_masks[0, 0, 0, 12, ::6], golden, rtol=0, atol=1e-3)


@pytest.mark.parametrize(
    ("build", "name"),
    [(build_sam2_image, "mask_decoder.iou_token.weight"), (build_sam2_video, "object_pointer_proj.proj_in.bias")],
)
def test_missing_tensor_is_named(build, name, checkpoint):
    left = {key: tensor for key, tensor in checkpoint.tensors.items() if key != name}
    with pytest.raises(InputError, match=re.escape(f"missing in weights tiny; got {name}")):
        build(checkpoint._replace(tensors=left))


@pytest.mark.parametrize("build", [build_sam2_image, build_sam2_video])
def test_left_over_tensor_is_named(build, checkpoint):
    with pytest.raises(InputError, match=r"not the network's in weights tiny; got text_encoder\.weight"):
        build(checkpoint._replace(tensors=dict(checkpoint.tensors) | {"text_encoder.weight": torch.zeros(1)}))


def test_boxes_get_masks_of_their_own(model, image):
    masks, quality = segment_boxes_sam2(model, image, BOXES, PARAMS)
    assert (masks.dtype, masks.shape) == (np.bool_, (4, 96, 128))
    assert (quality.dtype, quality.shape) == (np.float64, (4,))
    assert ((quality >= 0) & (quality <= 1)).all()
    for box, mask in zip(BOXES, masks, strict=True):
        assert iou(mask, fill_box(box)) > 0.65


def test_masks_do_not_depend_on_other_boxes(model, image):
    together, quality = segment_boxes_sam2(model, image, BOXES, PARAMS)
    alone, quality_alone = segment_boxes_sam2(model, image, BOXES, Sam2Params(boxes_per_pass=1))
    assert (together == alone).mean() > 0.999
    np.testing.assert_allclose(quality, quality_alone, atol=1e-5)


def test_masks_follow_the_frames_aspect(model):
    image = np.zeros((48, 256, 3), np.uint8)
    masks, _ = segment_boxes_sam2(model, image, BOXES * [2, 0.5, 2, 0.5], PARAMS)
    assert iou(masks[0], fill_box(BOXES[0] * [2, 0.5, 2, 0.5], (48, 256))) > 0.65


def test_no_boxes_give_no_masks(model, image):
    masks, quality = segment_boxes_sam2(model, image, np.zeros((0, 4), np.float32), PARAMS)
    assert masks.shape == (0, 96, 128)
    assert quality.shape == (0,)


def test_half_precision_is_near_full(model, image, in_half_precision, relative_error):
    def segment():
        outputs = []
        with model.register_forward_hook(lambda _module, _inputs, output: outputs.append(output.pred_masks)):
            masks, quality = segment_boxes_sam2(model, image, BOXES, PARAMS)
        return masks, quality, torch.cat(outputs)

    masks, quality, logits = in_half_precision(segment)
    assert (masks.dtype, masks.shape) == (np.bool_, (4, 96, 128))
    assert quality.dtype == np.float64 and ((quality >= 0) & (quality <= 1)).all()
    # The decoder works in single precision.
    assert logits.dtype == torch.float32
    assert relative_error(logits, segment()[2]) < 0.25


POINTS = np.array([[[40, 35], [30, 40]], [[95, 65], [100, 60]], [[15, 15], [5, 5]], [[50, 70], [80, 60]]], np.float32)


@pytest.mark.parametrize(("boxes", "points"), [(BOXES, POINTS), (BOXES, None), (None, POINTS)])
def test_prompts_get_three_masks_as_from_the_network_itself(boxes, points, model, image):
    masks, quality = segment_prompts_sam2(model, image, boxes, points, Sam2Params(boxes_per_pass=3))
    assert (masks.dtype, masks.shape) == (np.bool_, (4, 3, 96, 128))
    assert (quality.dtype, quality.shape) == (np.float64, (4, 3))
    pixels = frame_tensor(image, (128, 128), model.device, Resizing.TORCH_BILINEAR)
    given = {}
    if boxes is not None:
        given["input_boxes"] = torch.from_numpy(boxes * np.float32([1, 128 / 96, 1, 128 / 96]))[None]
    if points is not None:
        given["input_points"] = torch.from_numpy(points * np.float32([1, 128 / 96]))[None]
        given["input_labels"] = torch.ones((1, 4, 2), dtype=torch.int32)
    with torch.inference_mode():
        expected = model(pixels, **given)
    logits = functional.interpolate(expected.pred_masks[0], size=(96, 128), mode="bilinear")
    assert (masks == (logits > 0).numpy()).mean() > 0.999
    np.testing.assert_allclose(quality, expected.iou_scores[0].double().numpy(), atol=1e-5)


def test_points_and_boxes_reach_the_decoder(model, image):
    outputs = []
    with model.register_forward_hook(lambda _module, _inputs, output: outputs.append(output.pred_masks)):
        for boxes, points in ((BOXES, POINTS), (BOXES, POINTS[::-1]), (BOXES[::-1], POINTS), (None, POINTS)):
            segment_prompts_sam2(model, image, boxes, points, PARAMS)
    first, *others = outputs
    assert not any(torch.equal(first, other) for other in others)


def test_no_prompts_give_no_masks(model, image):
    masks, quality = segment_prompts_sam2(model, image, BOXES[:0], POINTS[:0], PARAMS)
    assert masks.shape == (0, 3, 96, 128) and quality.shape == (0, 3)


@pytest.mark.parametrize(
    ("boxes", "points", "what"),
    [
        (None, None, "no prompts"),
        (BOXES, POINTS[0], "not points"),
        (BOXES, POINTS[:, :0], "not points"),
        (BOXES, POINTS * np.nan, "not points"),
        (BOXES[:2], POINTS, "not one box for the points of each object"),
        (BOXES[:, :3], POINTS, "not boxes"),
    ],
)
def test_invalid_prompts_are_refused(model, image, boxes, points, what):
    with pytest.raises(InputError, match=what):
        segment_prompts_sam2(model, image, boxes, points, PARAMS)


@pytest.mark.parametrize("boxes", [BOXES[0], BOXES[:, :3], BOXES[:, [2, 1, 0, 3]], BOXES * np.nan])
def test_an_invalid_box_is_refused(model, image, boxes):
    with pytest.raises(InputError, match="not boxes"):
        segment_boxes_sam2(model, image, boxes, PARAMS)


def test_an_image_that_is_not_an_rgb_frame_is_refused(model, image):
    with pytest.raises(InputError, match="not an RGB frame"):
        segment_boxes_sam2(model, image[..., 0], BOXES, PARAMS)
