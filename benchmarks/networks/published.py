"""Networks of the published sizes with random weights, as the checkpoints that production builds them from."""

import json

import torch
from torch.nn import init
from transformers import (
    DepthAnythingConfig,
    DepthAnythingForDepthEstimation,
    Dinov2Config,
    DPTConfig,
    DPTForDepthEstimation,
    EdgeTamVideoConfig,
    EdgeTamVideoModel,
    GroundingDinoConfig,
    GroundingDinoForObjectDetection,
    PreTrainedConfig,
    PreTrainedModel,
    Sam2VideoConfig,
    Sam2VideoModel,
    Sam3VideoConfig,
    Sam3VideoModel,
    SamHQConfig,
    SamHQModel,
)

from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.bootstapir import BootsTapir, BootsTapirConfig
from moseg.tasks.networks.deaot import Deaot, DeaotConfig
from moseg.tasks.networks.depth_anything_3 import BASE, DepthAnything3Views
from moseg.tasks.networks.depth_anything_3 import SMALL as DA3_SMALL
from moseg.tasks.networks.edgetam.repvit import RepVitConfig
from moseg.tasks.networks.pips import Pips, PipsConfig
from moseg.tasks.networks.raft import Raft
from moseg.tasks.networks.raft.config import LARGE, SMALL
from moseg.tasks.networks.ram import RamConfig
from moseg.tasks.networks.ram.model import Ram, RamPlus
from moseg.tasks.networks.sea_raft import SeaRaft
from moseg.tasks.networks.sea_raft import config as sea_raft_sizes
from moseg.workflows.weights.tiny.grounding_dino import make_grounding_dino
from moseg.workflows.weights.tiny.sam3 import make_sam3
from moseg.workflows.weights.tiny.sea_raft import to_published_name


def ram(is_plus: bool) -> Checkpoint:
    config = RamConfig()
    documents = {
        "tags.txt": "".join(f"tag {index}\n" for index in range(config.num_tags)),
        "thresholds.txt": "0.65\n" * config.num_tags,
    }
    return Checkpoint("ram", _random_state((RamPlus if is_plus else Ram)(config)), documents)


def deaot() -> Checkpoint:
    return Checkpoint("deaot", _random_state(Deaot(DeaotConfig())))


def pips() -> Checkpoint:
    return Checkpoint("pips", _random_state(Pips(PipsConfig())))


def bootstapir() -> Checkpoint:
    return Checkpoint("bootstapir", _random_state(BootsTapir(BootsTapirConfig())))


def raft(is_small: bool) -> Checkpoint:
    return Checkpoint("raft", _random_state(Raft(SMALL if is_small else LARGE)))


def sea_raft(is_small: bool) -> Checkpoint:
    sizes = sea_raft_sizes.SMALL if is_small else sea_raft_sizes.MEDIUM
    state = _random_state(SeaRaft(sizes))
    return Checkpoint("sea-raft", {to_published_name(key): value for key, value in state.items()})


def grounding_dino(is_base: bool) -> Checkpoint:
    """Return the tiny network, transformers' default, or the base one with the authors' backbone swin_B_384_22k."""
    backbone = {"model_type": "swin", "out_indices": [2, 3, 4]}
    if is_base:
        larger = {"embed_dim": 128, "depths": [2, 2, 18, 2], "num_heads": [4, 8, 16, 32]}
        backbone |= larger | {"window_size": 12, "image_size": 384}
    # A vocabulary in BERT's layout with only a few words; the network's own embeddings have BERT's full size.
    vocabulary = make_grounding_dino(0).files["vocab.txt"].decode()
    documents = {
        "vocab.txt": vocabulary,
        "preprocessor_config.json": '{"size": {"shortest_edge": 800, "longest_edge": 1333}}',
    }
    return _checkpoint(GroundingDinoForObjectDetection, GroundingDinoConfig(backbone_config=backbone), documents)


def sam_hq(is_large: bool) -> Checkpoint:
    """Return ``sam_vit_b`` or ``sam_vit_l`` of the authors' ``build_sam.py``; the former is transformers' default."""
    larger = {"hidden_size": 1024, "num_hidden_layers": 24, "num_attention_heads": 16}
    vision = larger | {"global_attn_indexes": [5, 11, 17, 23]} if is_large else {}
    decoder = {"vit_dim": 1024 if is_large else 768}
    return _checkpoint(SamHQModel, SamHQConfig(vision_config=vision, mask_decoder_config=decoder))


def sam2(is_large: bool) -> Checkpoint:
    """Return ``sam2.1_hiera_t.yaml``, transformers' default, or ``sam2.1_hiera_l.yaml`` of the authors' code."""
    backbone = {"model_type": "sam2_hiera_det_model"}
    vision = {"model_type": "sam2_vision_model", "backbone_config": backbone}
    if is_large:
        widths = [144, 288, 576, 1152]
        backbone |= {"hidden_size": 144, "num_attention_heads": 2, "blocks_per_stage": [2, 6, 36, 4]}
        backbone |= {"embed_dim_per_stage": widths, "num_attention_heads_per_stage": [2, 4, 8, 16]}
        backbone |= {"window_size_per_stage": [8, 4, 16, 8], "global_attention_blocks": [23, 33, 43]}
        vision |= {"backbone_channel_list": widths[::-1]}
    return _checkpoint(Sam2VideoModel, Sam2VideoConfig(vision_config=vision))


def edgetam() -> Checkpoint:
    """Return ``edgetam.yaml`` of the authors' code; the image encoder is named as in the published file."""
    vision = {"model_type": "edgetam_vision_model", "backbone_config": RepVitConfig()}
    switches = ("enable_occlusion_spatial_embedding", "enable_temporal_pos_encoding_for_object_pointers")
    config = EdgeTamVideoConfig(vision_config=vision, **dict.fromkeys(switches, False))
    checkpoint = _checkpoint(EdgeTamVideoModel, config)
    content = json.loads(checkpoint.documents["config.json"])
    content["vision_config"]["backbone_config"] = {"model_type": "timm_wrapper", "architecture": "repvit_m1"}
    return checkpoint._replace(documents={"config.json": json.dumps(content)})


def sam3() -> Checkpoint:
    """Return transformers' default with a few words; the network's own embeddings have CLIP's full size."""
    documents = {name: make_sam3(0).files[name].decode() for name in ("vocab.json", "merges.txt")}
    config = Sam3VideoConfig()
    checkpoint = _checkpoint(Sam3VideoModel, config, documents)
    # The published file states what is the default, too.
    return checkpoint._replace(documents=documents | {"config.json": config.to_json_string(use_diff=False)})


def dpt_dinov2(is_large: bool) -> Checkpoint:
    """Return ``vit_small`` or ``vit_large`` with the head of ``hub/depthers.py`` in the authors' code."""
    width, num_layers, outputs = (1024, 24, [5, 12, 18, 24]) if is_large else (384, 12, [3, 6, 9, 12])
    config = DPTConfig(
        backbone_config=_dinov2(width, num_layers, outputs, apply_layernorm=False),
        neck_hidden_sizes=[width // 8, width // 4, width // 2, width],
        fusion_hidden_size=256,
        use_bias_in_fusion_residual=False,
        add_projection=True,
    )
    return _checkpoint(DPTForDepthEstimation, config)


def depth_anything_small() -> Checkpoint:
    """Return ``vits`` of the authors' ``run.py``."""
    config = DepthAnythingConfig(
        backbone_config=_dinov2(384, 12, [3, 6, 9, 12], apply_layernorm=True),
        reassemble_hidden_size=384,
        neck_hidden_sizes=[48, 96, 192, 384],
        fusion_hidden_size=64,
    )
    return _checkpoint(DepthAnythingForDepthEstimation, config)


def depth_anything_3(is_base: bool) -> Checkpoint:
    sizes = BASE if is_base else DA3_SMALL
    state = _random_state(DepthAnything3Views(sizes)) | _random_state(DepthAnything3Views(sizes, has_rays=True))
    document = json.dumps({"model_name": "da3-base" if is_base else "da3-small"})
    return Checkpoint("depth-anything-3", state, {"config.json": document})


def _dinov2(width: int, num_layers: int, outputs: list[int], apply_layernorm: bool) -> Dinov2Config:
    """Return a backbone whose heads have 64 channels, as all of DINOv2."""
    return Dinov2Config(
        hidden_size=width,
        num_hidden_layers=num_layers,
        num_attention_heads=width // 64,
        image_size=518,
        patch_size=14,
        out_indices=outputs,
        reshape_hidden_states=False,
        apply_layernorm=apply_layernorm,
    )


def _checkpoint(
    model_class: type[PreTrainedModel], config: PreTrainedConfig, documents: dict[str, str] | None = None
) -> Checkpoint:
    state = model_class(config).state_dict()
    return Checkpoint(model_class.__name__, state, (documents or {}) | {"config.json": config.to_json_string()})


def _random_state(module: torch.nn.Module) -> dict[str, torch.Tensor]:
    """Return weights of unit gain, because denormal numbers would slow down the arithmetic."""
    state = module.state_dict()
    for tensor in state.values():
        if tensor.ndim > 1 and tensor.is_floating_point():
            init.normal_(tensor, std=max(tensor[0].numel(), 1) ** -0.5)
    return state
