"""What the published files of transformers' networks hold that those it writes today do not."""

import io
import json

import pytest
import torch
from safetensors.torch import load

from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth import build_depth_anything, build_dpt_dinov2
from moseg.tasks.networks.grounding_dino import build_grounding_dino
from moseg.tasks.networks.sam2 import build_sam2_image, build_sam2_video
from moseg.tasks.networks.sam_hq import build_sam_hq
from moseg.workflows.weights.tiny.depth_anything import make_depth_anything
from moseg.workflows.weights.tiny.dpt_dinov2 import make_dpt_dinov2
from moseg.workflows.weights.tiny.grounding_dino import make_grounding_dino
from moseg.workflows.weights.tiny.sam2 import make_sam2
from moseg.workflows.weights.tiny.sam_hq import make_sam_hq

UNUSED = ("attention_probs_dropout_prob", "backbone_featmap_shape", "backbone_out_indices", "hidden_dropout_prob")
UNUSED += ("image_size", "intermediate_size", "layer_norm_eps", "num_attention_heads", "num_channels")
UNUSED += ("num_hidden_layers", "patch_size", "qkv_bias")
NO_BACKBONE = {"backbone": None, "use_pretrained_backbone": False}
UNVERSIONED = {"_commit_hash": None, "transformers_version": None, "torch_dtype": "float32"}
NO_MODEL = {"model_type": ""}

PUBLISHED = {
    "dpt_dinov2": (
        make_dpt_dinov2,
        build_dpt_dinov2,
        {
            **UNVERSIONED,
            **dict.fromkeys(UNUSED),
            "hidden_size": 768,
            "is_hybrid": False,
            "neck_ignore_stages": [],
            "backbone_config": {
                "label2id": {"LABEL_0": 0},
                "bos_token_id": None,
                "use_bfloat16": False,
                "max_length": 20,
            },
        },
    ),
    "depth_anything": (make_depth_anything, build_depth_anything, {**UNVERSIONED, **NO_BACKBONE}),
    "grounding_dino": (
        make_grounding_dino,
        build_grounding_dino,
        {**NO_BACKBONE, "backbone_kwargs": None, "use_timm_backbone": False, "query_dim": 4, "torch_dtype": "float32"},
    ),
    "sam_hq": (make_sam_hq, build_sam_hq, {"prompt_encoder_config": NO_MODEL, "mask_decoder_config": NO_MODEL}),
    "sam2_image": (make_sam2, build_sam2_image, {"memory_attention_rope_theta": 10000}),
    "sam2_video": (make_sam2, build_sam2_video, {"memory_attention_rope_theta": 10000}),
}


def read(make, config=None):
    """A tiny checkpoint, with some of its configuration changed."""
    files = make(0).files
    document = _merge(json.loads(files["config.json"]), config or {})
    documents = {name: content.decode() for name, content in files.items() if name.endswith((".json", ".txt"))}
    if "model.bin" in files:
        tensors = torch.load(io.BytesIO(files["model.bin"]), weights_only=True)
    else:
        tensors = load(files["model.safetensors"])
    return Checkpoint("tiny", tensors, documents | {"config.json": json.dumps(document)})


def _merge(document, changes):
    return document | {
        key: _merge(document[key], value) if isinstance(value, dict) else value for key, value in changes.items()
    }


def _state(built):
    return getattr(built, "model", built).state_dict()


@pytest.mark.parametrize("network", PUBLISHED)
def test_the_configuration_of_their_time_makes_the_same_network(network):
    make, build, config = PUBLISHED[network]
    now, then = _state(build(read(make))), _state(build(read(make, config)))
    assert now.keys() == then.keys()
    assert all(torch.equal(now[name], then[name]) for name in now)


@pytest.mark.parametrize("home", ["bbox_embed.0.", "model.decoder.bbox_embed.0."])
def test_the_shared_box_head_of_grounding_dino_is_kept_under_either_name(home):
    """``-tiny`` has it under the first, ``-base`` under the second; the other names of it were left out."""
    checkpoint = read(make_grounding_dino)
    shared = {name for name in checkpoint.tensors if name.startswith(("bbox_embed.", "model.decoder.bbox_embed."))}
    head = {name[name.index("layers.") :]: checkpoint.tensors[name] for name in shared}
    others = {name: tensor for name, tensor in checkpoint.tensors.items() if name not in shared}
    state = _state(build_grounding_dino(checkpoint._replace(tensors=others | {home + k: v for k, v in head.items()})))
    heads = [name for name in state if name.startswith(("bbox_embed.", "model.decoder.bbox_embed."))]
    assert len(heads) > len(head)
    assert all(torch.equal(state[name], head[name[name.index("layers.") :]].float()) for name in heads)
