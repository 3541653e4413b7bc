"""A tiny checkpoint of EdgeTAM that outlines boxes as boxes; its tracker loses objects after their first frame."""

import json

import torch
from transformers import EdgeTamVideoConfig, EdgeTamVideoModel

from moseg.tasks.networks.edgetam.build import BACKBONE
from moseg.tasks.networks.edgetam.repvit import RepVitConfig
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint, save_to_bytes
from moseg.workflows.weights.tiny.sam2 import (
    GRID,
    MEMORY,
    OUTSIDE,
    SIDE,
    WIDTH,
    compare_with_corners,
    place_tokens,
    randomise,
    show_inside,
)

WIDTHS, DEPTHS = (8, 16, 24, 32), (1, 1, 2, 1)


def make_edgetam(seed: int) -> TinyCheckpoint:
    """Return the published network, half precision, with half the hidden channels, a small backbone and 128 px."""
    with torch.random.fork_rng(devices=()), torch.no_grad():
        torch.manual_seed(seed)
        model = EdgeTamVideoModel(_config()).eval()
        for name, tensor in model.state_dict().items():
            if ".bn." not in name:
                randomise(name, tensor)
        place_tokens(model, model.vision_encoder.neck.convs)
        compare_with_corners(model.mask_decoder.transformer.layers[0])
        show_inside(model)
        # What the memory says is that all pixels are outside of the object.
        model.memory_attention.layers[0].cross_attn_image.o_proj.bias[0] = OUTSIDE
    files = save_to_bytes(model.half())
    content = json.loads(files["config.json"])
    sizes = {"embed_dim": WIDTHS, "depth": DEPTHS}
    backbone = {"model_type": "timm_wrapper", "architecture": BACKBONE, "model_args": sizes}
    content["vision_config"]["backbone_config"] = backbone
    return TinyCheckpoint(files | {"config.json": json.dumps(content).encode()})


def _config() -> EdgeTamVideoConfig:
    decoder = {
        "hidden_size": WIDTH,
        "mlp_dim": 16,
        "num_hidden_layers": 1,
        "num_attention_heads": 4,
        "attention_downsample_rate": 4,
        "iou_head_hidden_dim": 16,
    }
    return EdgeTamVideoConfig(
        vision_config={
            "model_type": "edgetam_vision_model",
            "backbone_config": RepVitConfig(WIDTHS, DEPTHS),
            "backbone_channel_list": list(WIDTHS[::-1]),
            "backbone_feature_sizes": [[4 * GRID] * 2, [2 * GRID] * 2, [GRID] * 2],
            "fpn_hidden_size": WIDTH,
        },
        prompt_encoder_config={"hidden_size": WIDTH, "image_size": SIDE, "mask_input_channels": 8},
        mask_decoder_config=decoder,
        image_size=SIDE,
        enable_occlusion_spatial_embedding=False,
        enable_temporal_pos_encoding_for_object_pointers=False,
        memory_attention_hidden_size=WIDTH,
        memory_attention_num_layers=1,
        memory_attention_mlp_hidden_size=16,
        memory_attention_rope_feat_sizes=[GRID, GRID],
        memory_attention_rope_k_sizes=[GRID // 2, GRID // 2],
        perceiver_resampler_num_latents=4,
        perceiver_resampler_num_latents_2d=(GRID // 2) ** 2,
        perceiver_resampler_mlp_intermediate_size=16,
        perceiver_resampler_num_layers=1,
        memory_encoder_hidden_size=WIDTH,
        memory_encoder_output_channels=MEMORY,
        mask_downsampler_embed_dim=WIDTH,
        memory_fuser_num_layers=1,
        memory_fuser_embed_dim=WIDTH,
        memory_fuser_intermediate_dim=16,
    )
