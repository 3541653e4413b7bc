"""A tiny random checkpoint of Depth Anything 3, in the layout of the hub's files."""

import json

import torch
from safetensors.torch import save

from moseg.tasks.networks.depth_anything_3 import SMALL, DepthAnything3, DepthAnything3Config, DepthAnything3Views
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint

_SIZES = {
    "width": 16,
    "num_layers": 4,
    "num_heads": 2,
    "grid_side": 5,
    "multi_view_from": 1,
    "output_layers": (0, 1, 2, 3),
    "stage_channels": (4, 8, 12, 16),
    "fusion_channels": 8,
}
# Of the last layer, whose answer is a logarithm: depths of random weights stay within some octaves.
_LAST, _LAST_GAIN = "scratch.output_conv2.2.weight", 0.3
# Of the field of view, rad, and of the rotation's real part: cameras of random weights look ahead.
_BIASES = {"cam_dec.fc_fov.0.bias": (0.7, 1.0), "cam_dec.fc_qvec.bias": (0.0, 0.0, 0.0, 5.0)}
# Tensors of parts that are not read, which the published files hold too.
_UNUSED = {
    "model.cam_enc.token_norm.weight": (16,),
    "model.head.scratch.output_conv1_aux.0.0.weight": (4, 8, 3, 3),
    "model.head.scratch.output_conv2_aux.0.0.weight": (32, 4, 3, 3),
}


def make_depth_anything_3(seed: int) -> TinyCheckpoint:
    """Return the small network at a fraction of its widths and with fewer layers, with cameras and rays."""
    sizes = DepthAnything3Config.model_validate(SMALL.model_dump() | _SIZES)
    with torch.device("meta"):
        shapes = DepthAnything3(sizes).state_dict()
        others = DepthAnything3Views(sizes).state_dict() | DepthAnything3Views(sizes, has_rays=True).state_dict()
    generator = torch.Generator().manual_seed(seed)
    # Those of single images first, so that other parts do not change their values.
    names = dict.fromkeys([*shapes, *others])
    tensors = {f"model.{name}": _random_tensor(name, others[name], generator) for name in names}
    tensors |= {name: torch.zeros(shape) for name, shape in _UNUSED.items()}
    config = json.dumps({"model_name": "da3-small", "config": _authors_config()}, indent=2)
    return TinyCheckpoint({"config.json": config.encode(), "model.safetensors": save(tensors)}, dict(_SIZES))


def _authors_config() -> dict:
    """Return what ``config.json`` of DA3-SMALL says of its parts, of which we read the name alone."""
    parts = {"": ("da3", "DepthAnything3Net"), "net": ("dinov2.dinov2", "DinoV2"), "head": ("dualdpt", "DualDPT")}
    parts |= {"cam_enc": ("cam_enc", "CameraEnc"), "cam_dec": ("cam_dec", "CameraDec")}
    classes = {
        key: {"__object__": {"path": f"depth_anything_3.model.{module}", "name": name, "args": "as_params"}}
        for key, (module, name) in parts.items()
    }
    starts = dict.fromkeys(("alt_start", "qknorm_start", "rope_start"), 4)
    sizes = {
        "net": {"name": "vits", "out_layers": [5, 7, 9, 11], **starts, "cat_token": True},
        "head": {"dim_in": 768, "output_dim": 2, "features": 64, "out_channels": [48, 96, 192, 384]},
        "cam_enc": {"dim_out": 384},
        "cam_dec": {"dim_in": 768},
    }
    return classes[""] | {key: classes[key] | values for key, values in sizes.items()}


def _random_tensor(name: str, like: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
    """Return weights of unit gain; biases near zero, scales near one."""
    noise = torch.randn(like.shape, generator=generator)
    if name in _BIASES:
        return torch.tensor(_BIASES[name])
    if like.ndim > 1:
        return noise * like[0].numel() ** -0.5 * (_LAST_GAIN if name.endswith(_LAST) else 1.0)
    return 0.1 * noise + (not name.endswith("bias"))
