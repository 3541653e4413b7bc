"""Agreement of EdgeTAM by transformers and our RepViT, as our kernels run them, with the authors' code.

Run ``python benchmarks/agreement/edgetam.py --official DIR``, DIR being a checkout of facebookresearch/EdgeTAM beside
which, in the folder ``timm``, lies timm's package (``pip download --no-deps timm==1.0.19``, unpacked); neither
torchvision nor hydra is needed. What is compared, and how, is the same as for SAM 2.1.
"""

import importlib
import json
import re
import sys
import types
from functools import partial
from pathlib import Path

import sam2_family
import torch
import torchvision_parts
from sam2_family import GRID, SIDE
from transformers import EdgeTamModel, EdgeTamVideoConfig

from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.edgetam import build_edgetam_image, build_edgetam_video
from moseg.tasks.networks.edgetam.build import BACKBONE, EdgeTamVideo
from moseg.tasks.networks.edgetam.repvit import RepVitConfig
from moseg.tasks.networks.frame_tensor import frame_tensor

# Before those that are the same as of SAM 2.1.
NAMES = (
    (r"timm_model\.", "body."),
    (r"^memory_attention(.*)mlp\.up_proj", r"memory_attention\1linear1"),
    (r"^memory_attention(.*)mlp\.down_proj", r"memory_attention\1linear2"),
    (r"latents_1d", "latents"),
    (r"(perceiver.*)self_mlp\.", r"\1self_ff."),
    (r"(perceiver.*)\.mlp\.", r"\1.ff."),
    (r"(perceiver.*ff)\.layer_norm", r"\1.0"),
    (r"(perceiver.*ff)\.up_proj", r"\1.1"),
    (r"(perceiver.*ff)\.down_proj", r"\1.3"),
    (r"layer_norm_input", "attn.norm_x"),
    (r"layer_norm_latents", "attn.norm_latents"),
    (r"layer_norm_self", "self_attn.norm"),
    (r"cross_attention\.", "attn."),
    (r"self_attention\.", "self_attn."),
    (r"(perceiver.*)q_proj", r"\1to_q"),
    (r"(perceiver.*)\.o_proj", r"\1.to_out"),
    *sam2_family.NAMES,
)


def our_config() -> EdgeTamVideoConfig:
    """Return the configuration of the published network for smaller images."""
    return EdgeTamVideoConfig(
        vision_config={
            "model_type": "edgetam_vision_model",
            "backbone_config": RepVitConfig(),
            "backbone_feature_sizes": [[4 * GRID] * 2, [2 * GRID] * 2, [GRID] * 2],
        },
        prompt_encoder_config={"image_size": SIDE},
        image_size=SIDE,
        memory_attention_rope_feat_sizes=[GRID, GRID],
        enable_occlusion_spatial_embedding=False,
        enable_temporal_pos_encoding_for_object_pointers=False,
    )


def compare(folder: Path) -> bool:
    """Return whether our networks agree with the authors' code in a folder."""
    _import_repvit(folder.parent / "timm")
    official = sam2_family.official_predictor(folder, "edgetam.yaml", _reduce)
    perceiver = official.spatial_perceiver
    # Their code views an expanded tensor, which works for one object at a time.
    perceiver.forward_2d = partial(_one_by_one, perceiver.forward_2d)
    return sam2_family.compare(official, random_state(), load)


def random_state() -> dict[str, torch.Tensor]:
    """Return random weights, with the normalisations of the backbone as after training on one image.

    Without that, signals would grow by the branches of every block, and objects would be lost in the rounding.
    """
    model = EdgeTamVideo(our_config())
    state = model.state_dict()
    counts = {name: value for name, value in state.items() if name.endswith("num_batches_tracked")}
    state = sam2_family.randomise({name: value for name, value in state.items() if name not in counts})
    for name, value in state.items():
        if re.search(r"bn\.(weight|running_var)$", name):
            # Small branches beside the blocks' inputs: large ones amplify roundings from block to block.
            state[name] = (1 + 0.1 * value) * (0.2 if "conv2.bn" in name and "stem" not in name else 1)
    model.load_state_dict(state | counts)
    backbone = model.vision_encoder.backbone.train()
    for layer in backbone.modules():
        if isinstance(layer, torch.nn.BatchNorm2d):
            layer.momentum = 1.0
    frames, _ = sam2_family.moving_discs(1)
    backbone(frame_tensor(frames[0], (SIDE, SIDE), torch.device("cpu")))
    return model.state_dict()


def _one_by_one(forward, memories: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    latents, places = zip(*(forward(memory[None]) for memory in memories), strict=True)
    return torch.cat(latents), torch.cat(places)


def _import_repvit(folder: Path) -> None:
    """Import timm's RepViT alone: its packages import torchvision."""
    sys.path.insert(0, str(folder.parent))
    for name in ("timm", "timm.models"):
        sys.modules[name] = types.ModuleType(name)
        sys.modules[name].__path__ = [str(folder / name.partition(".")[2])]
    sys.modules["timm"].__version__ = ""
    torchvision_parts.stand_in()
    misc = sys.modules["torchvision.ops.misc"] = types.ModuleType("torchvision.ops.misc")
    misc.FrozenBatchNorm2d = torch.nn.BatchNorm2d
    data = sys.modules["timm.data"] = types.ModuleType("timm.data")
    data.IMAGENET_DEFAULT_MEAN = data.IMAGENET_DEFAULT_STD = None
    repvit = importlib.import_module("timm.models.repvit")

    def create_model(name: str, pretrained: bool, **arguments):
        return getattr(repvit, name.partition(".")[0])(**arguments)

    sys.modules["timm.models"].create_model = create_model


def _reduce(model: dict) -> None:
    layer = model["memory_attention"]["layer"]
    layer["self_attention"]["feat_sizes"] = layer["cross_attention"]["q_sizes"] = [GRID, GRID]


def load(official: torch.nn.Module, state: dict[str, torch.Tensor]) -> tuple[EdgeTamModel, EdgeTamVideo]:
    """Return our networks with these weights, which the official one loads as well."""
    tensors = sam2_family.official_names(state, NAMES)
    for name in [name for name in tensors if re.search(r"perceiver.*k_proj", name)]:
        pair = [tensors.pop(name), tensors.pop(name.replace("k_proj", "v_proj"))]
        tensors[name.replace("k_proj", "to_kv")] = torch.cat(pair)
    official.load_state_dict(tensors)
    content = json.loads(our_config().to_json_string())
    content["vision_config"]["backbone_config"] = {"model_type": "timm_wrapper", "architecture": BACKBONE}
    checkpoint = Checkpoint("random", state, {"config.json": json.dumps(content)})
    return build_edgetam_image(checkpoint), build_edgetam_video(checkpoint)


if __name__ == "__main__":
    sys.exit(sam2_family.run(__doc__.splitlines()[0], "facebookresearch/EdgeTAM", compare))
