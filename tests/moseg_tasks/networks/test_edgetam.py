import json
import re

import numpy as np
import pytest
import torch
from safetensors.torch import load
from transformers import EdgeTamVideoConfig, EdgeTamVideoModel

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import EdgeTamParams
from moseg.tasks.instances.sam2 import segment_boxes_sam2, segment_prompts_sam2
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.edgetam import build_edgetam_image, build_edgetam_video
from moseg.tasks.networks.edgetam.repvit import RepVitConfig
from moseg.tasks.proposals.sam2 import track_masks_sam2
from moseg.workflows.weights.tiny.edgetam import make_edgetam

PARAMS = EdgeTamParams()
BOXES = np.array([[20, 20, 60, 50], [80, 50, 110, 80]], np.float32)
BACKBONE = "vision_encoder.backbone.timm_model."


@pytest.fixture(scope="module")
def checkpoint():
    files = make_edgetam(0).files
    return Checkpoint("tiny", load(files["model.safetensors"]), {"config.json": files["config.json"].decode()})


@pytest.fixture
def image():
    return np.random.default_rng(0).integers(0, 256, (96, 128, 3), np.uint8)


def fill_box(box):
    y, x = np.mgrid[:96, :128]
    return (x >= box[0]) & (x < box[2]) & (y >= box[1]) & (y < box[3])


def iou(mask0, mask1):
    return np.count_nonzero(mask0 & mask1) / np.count_nonzero(mask0 | mask1)


def with_config(checkpoint, change):
    content = json.loads(checkpoint.documents["config.json"])
    change(content["vision_config"])
    return checkpoint._replace(documents={"config.json": json.dumps(content)})


def test_published_network_has_its_size_and_names():
    vision = {"model_type": "edgetam_vision_model", "backbone_config": RepVitConfig()}
    switches = ("enable_occlusion_spatial_embedding", "enable_temporal_pos_encoding_for_object_pointers")
    with torch.device("meta"):
        model = EdgeTamVideoModel(EdgeTamVideoConfig(vision_config=vision, **dict.fromkeys(switches, False)))
    state = model.state_dict()
    # 13.9 million in the paper.
    assert sum(tensor.numel() for tensor in model.parameters()) == 13_895_794
    assert len(state) == 984
    shapes = {
        "stem.conv1.c.weight": (24, 3, 3, 3),
        "stages_0.blocks.0.se.fc1.weight": (16, 48, 1, 1),
        "stages_1.downsample.spatial_downsample.c.weight": (48, 1, 3, 3),
        "stages_2.blocks.13.token_mixer.conv1.bn.running_var": (192,),
        "stages_2.blocks.12.se.fc2.bias": (192,),
        "stages_3.blocks.1.channel_mixer.conv2.c.weight": (384, 768, 1, 1),
    }
    assert {name: tuple(state[BACKBONE + name].shape) for name in shapes} == shapes
    assert not any("blocks.1.se" in name for name in state)


@pytest.mark.parametrize("build", [build_edgetam_image, build_edgetam_video])
def test_network_is_ready_for_inference(build, checkpoint):
    model = build(checkpoint)
    assert not model.training
    assert {tensor.dtype for tensor in model.parameters()} == {torch.float32}
    loaded = model.state_dict()[BACKBONE + "stem.conv2.c.weight"]
    assert torch.equal(loaded, checkpoint.tensors[BACKBONE + "stem.conv2.c.weight"].float())


@pytest.mark.parametrize(
    ("build", "name"),
    [
        (build_edgetam_image, BACKBONE + "stages_0.blocks.0.token_mixer.conv.bn.running_mean"),
        (build_edgetam_video, "spatial_perceiver.latents_2d"),
    ],
)
def test_missing_tensor_is_named(build, name, checkpoint):
    left = {key: tensor for key, tensor in checkpoint.tensors.items() if key != name}
    with pytest.raises(InputError, match=re.escape(f"missing in weights tiny; got {name}")):
        build(checkpoint._replace(tensors=left))


@pytest.mark.parametrize("build", [build_edgetam_image, build_edgetam_video])
def test_left_over_tensor_is_named(build, checkpoint):
    with pytest.raises(InputError, match=r"not the network's in weights tiny; got head\.weight"):
        build(checkpoint._replace(tensors=dict(checkpoint.tensors) | {"head.weight": torch.zeros(1)}))


def test_another_image_encoder_is_refused(checkpoint):
    def change(vision):
        vision["backbone_config"]["architecture"] = "repvit_m2.dist_in1k"

    with pytest.raises(InputError, match=r"another image encoder in config.json of weights tiny; got repvit_m2\.dist"):
        build_edgetam_video(with_config(checkpoint, change))
    with pytest.raises(
        InputError, match=r"another image encoder in config\.json of weights tiny; expected timm's repvit"
    ):
        build_edgetam_video(with_config(checkpoint, lambda vision: vision.pop("backbone_config")))


def test_the_release_that_timm_trained_is_accepted(checkpoint):
    def change(vision):
        vision["backbone_config"]["architecture"] += ".dist_in1k"

    assert build_edgetam_image(with_config(checkpoint, change)) is not None


def test_boxes_get_masks_of_their_own(checkpoint, image):
    masks, quality = segment_boxes_sam2(build_edgetam_image(checkpoint), image, BOXES, PARAMS)
    assert masks.shape == (2, 96, 128) and quality.shape == (2,)
    for box, mask in zip(BOXES, masks, strict=True):
        assert iou(mask, fill_box(box)) > 0.6


def test_points_get_three_masks(checkpoint, image):
    points = np.array([[[40, 35]], [[95, 65]]], np.float32)
    masks, quality = segment_prompts_sam2(build_edgetam_image(checkpoint), image, None, points, PARAMS)
    assert masks.shape == (2, 3, 96, 128) and quality.shape == (2, 3)


def test_tracking_starts_from_the_seeds_and_does_not_depend_on_other_objects(checkpoint, image):
    model = build_edgetam_video(checkpoint)
    seeds = np.zeros((96, 128), np.uint16)
    seeds[20:50, 20:60], seeds[60:80, 80:110] = 1, 2
    together = track_masks_sam2(model, [image] * 3, seeds, PARAMS)
    alone = track_masks_sam2(model, [image] * 3, seeds, EdgeTamParams(objects_per_pass=1))
    assert together.shape == (3, 96, 128)
    np.testing.assert_array_equal(together[0], seeds)
    assert (together == alone).mean() > 0.999
