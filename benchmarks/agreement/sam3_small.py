"""Small SAM 3 with the same random weights in our code and in the authors', whose imports have stand-ins."""

import contextlib
import importlib
import json
import re
import sys
import types
from pathlib import Path
from unittest import mock

import numpy as np
import sam2_family
import torch
import torchvision_parts
from PIL import Image
from sam3_names import official_detector, official_tracker
from transformers import Sam3VideoConfig, Sam3VideoModel

from moseg.tasks.networks import Checkpoint

GRID, PATCH = 16, 14
SIDE = GRID * PATCH
WIDTH, HEADS, WINDOW, LAYERS, GLOBAL = 64, 4, 8, 4, (1, 3)
TEXT = {"width": 64, "heads": 4, "layers": 3}


def our_config() -> Sam3VideoConfig:
    """Return the configuration of the published network with small encoders and images."""
    backbone = {
        "model_type": "sam3_vit_model",
        "hidden_size": WIDTH,
        "intermediate_size": int(WIDTH * 4.625),
        "num_hidden_layers": LAYERS,
        "num_attention_heads": HEADS,
        "image_size": SIDE,
        "pretrain_image_size": SIDE // 2,
        "window_size": WINDOW,
        "global_attn_indexes": list(GLOBAL),
        # Theirs; transformers' default is 1e-6.
        "layer_norm_eps": 1e-5,
    }
    sizes = [[4 * GRID] * 2, [2 * GRID] * 2, [GRID] * 2]
    vision = {"model_type": "sam3_vision_model", "backbone_config": backbone, "backbone_feature_sizes": sizes}
    text = {
        "model_type": "clip_text_model",
        "vocab_size": 49408,
        "hidden_size": TEXT["width"],
        "intermediate_size": 4 * TEXT["width"],
        "projection_dim": 512,
        "num_hidden_layers": TEXT["layers"],
        "num_attention_heads": TEXT["heads"],
        "max_position_embeddings": 32,
        "hidden_act": "gelu",
    }
    tracker = {"model_type": "sam3_tracker_video", "vision_config": vision, "image_size": SIDE}
    detector = {"model_type": "sam3", "vision_config": vision, "text_config": text}
    return Sam3VideoConfig(detector_config=detector, tracker_config=tracker)


def random_state() -> dict[str, torch.Tensor]:
    """Return weights under the published names that keep the signals' size from layer to layer."""
    with torch.device("meta"):
        state = Sam3VideoModel(our_config()).state_dict()
    prefix = "tracker_model."
    tracker = {name.removeprefix(prefix): torch.randn(state[name].shape) for name in state if prefix in name}
    tensors = {prefix + name: value for name, value in sam2_family.randomise(tracker).items()}
    for name in (name for name in state if name not in tensors):
        value = torch.randn(state[name].shape)
        if "norm" in name:
            value = 0.1 * value + name.endswith("weight")
        elif name.endswith("bias"):
            value *= 0.1
        elif value.ndim > 1 and not re.search(r"embed(ding)?s?\.|embeddings$|token|reference", name):
            # Transposed convolutions keep their input channels first.
            value *= (value[0].numel() if "scale_layers" not in name else len(value)) ** -0.5
        tensors[name] = value
    return tensors


def our_checkpoint(state: dict[str, torch.Tensor], tokenizer) -> Checkpoint:
    """Return the checkpoint of these weights, with the authors' tokens under CLIP's names."""
    names = {"<start_of_text>": "<|startoftext|>", "<end_of_text>": "<|endoftext|>"}
    documents = {
        "config.json": our_config().to_json_string(use_diff=False),
        "vocab.json": json.dumps({names.get(token, token): number for token, number in tokenizer.encoder.items()}),
        "merges.txt": "".join(f"{line}\n" for line in ("#version: 0.2", *map(" ".join, tokenizer.bpe_ranks))),
    }
    return Checkpoint("random", state, documents)


def import_official(folder: Path):
    """Return the authors' module that builds their networks, with stand-ins for what it imports."""
    torchvision_parts.stand_in()
    names = ["torchvision.transforms.v2", "torchvision.ops.roi_align", "timm", "timm.layers", "ftfy", "pkg_resources"]
    names += ["iopath", "iopath.common", "iopath.common.file_io"]
    found = {name: types.ModuleType(name) for name in names}
    sys.modules.update(found)
    unused = ["einops", "triton", "triton.language", "sam3.train.data.collator"]
    unused += [f"sam3.model.sam3_video_{part}" for part in ("inference", "predictor")]
    sys.modules.update({name: mock.MagicMock() for name in unused})
    found["timm.layers"].DropPath = lambda share: torch.nn.Identity()
    found["timm.layers"].Mlp = Mlp
    found["timm.layers"].trunc_normal_ = torch.nn.init.trunc_normal_
    found["ftfy"].fix_text = lambda text: text
    found["iopath.common.file_io"].g_pathmgr = types.SimpleNamespace(open=open)
    found["torchvision.ops.roi_align"].RoIAlign = None
    sys.modules["torchvision.ops"].roi_align = lambda features, boxes, size: features.new_zeros(
        sum(map(len, boxes)), features.shape[1], size, size
    )
    v2 = found["torchvision.transforms.v2"]
    v2.Compose, v2.Resize, v2.Normalize, v2.ToDtype = (
        torchvision_parts.Compose,
        Resize,
        torchvision_parts.Normalize,
        ToDtype,
    )
    v2.functional = types.SimpleNamespace(to_image=lambda image: torch.from_numpy(np.array(image)).permute(2, 0, 1))
    sys.modules["torchvision.transforms"].v2 = v2
    sys.path.insert(0, str(folder))
    return importlib.import_module("sam3.model_builder")


class Mlp(torch.nn.Module):
    """timm's."""

    def __init__(self, in_features, hidden_features, act_layer, drop):
        super().__init__()
        self.fc1, self.act = torch.nn.Linear(in_features, hidden_features), act_layer()
        self.fc2 = torch.nn.Linear(hidden_features, in_features)

    def forward(self, features):
        return self.fc2(self.act(self.fc1(features)))


class ToDtype(torch.nn.Module):
    """Grey levels as they are, or in 0..1."""

    def __init__(self, dtype, scale):
        super().__init__()
        self.dtype = dtype

    def forward(self, image):
        return image if self.dtype == torch.uint8 else image.to(self.dtype) / 255


class Resize(torch.nn.Module):
    """Of grey levels by PIL; torchvision's differ from these by a level or two in 0.2 to 2.6 % of the values."""

    def __init__(self, size):
        super().__init__()
        self.size = size

    def forward(self, image):
        resized = torchvision_parts.resize(Image.fromarray(image.permute(1, 2, 0).numpy()), self.size)
        return torch.from_numpy(np.array(resized)).permute(2, 0, 1)


def build_official(builder, folder: Path, state: dict[str, torch.Tensor]):
    """Return the authors' detector and tracker with these weights, for smaller images."""
    small = {"img_size": SIDE, "pretrain_img_size": SIDE // 2, "embed_dim": WIDTH, "depth": LAYERS}
    small |= {"num_heads": HEADS, "window_size": WINDOW, "global_att_blocks": GLOBAL}
    changes = {
        "ViT": small,
        "PositionEmbeddingSine": {"precompute_resolution": None},
        "TransformerDecoder": {"resolution": None, "stride": None},
        "VETextEncoder": TEXT,
        "RoPEAttention": {"feat_sizes": [GRID, GRID]},
        "SimpleMaskDownSampler": {"interpol_size": [16 * GRID] * 2},
        "Sam3TrackerPredictor": {"image_size": SIDE},
    }
    with contextlib.ExitStack() as stack:
        for name, values in changes.items():
            stack.enter_context(mock.patch.object(builder, name, _with(getattr(builder, name), values)))
        vocabulary = str(folder / "sam3" / "assets" / "bpe_simple_vocab_16e6.txt.gz")
        detector = builder.build_sam3_image_model(bpe_path=vocabulary, device="cpu", load_from_HF=False)
        tracker = builder.build_tracker(apply_temporal_disambiguation=False, with_backbone=True).eval()
    parts = {
        part: {name.removeprefix(part): value for name, value in state.items() if name.startswith(part)}
        for part in ("detector_model.", "tracker_model.", "tracker_neck.")
    }
    _load(detector, official_detector(parts["detector_model."]))
    tensors = official_tracker(parts["tracker_model."], parts["tracker_neck."], detector.state_dict())
    _load(tracker, tensors)
    return detector, tracker


def _with(make, values: dict):
    return lambda *args, **given: make(*args, **(given | values))


def _load(model: torch.nn.Module, tensors: dict[str, torch.Tensor]) -> None:
    """Load tensors; what is missing or left over may only be rotations, points as prompts and an unused projection."""
    found = model.load_state_dict(tensors, strict=False)
    unset = [name for name in found.missing_keys if not re.search(r"freqs_cis|points_|text_projection", name)]
    if unset or found.unexpected_keys:
        raise SystemExit(f"missing: {unset[:9]}\nleft over: {found.unexpected_keys[:9]}")
