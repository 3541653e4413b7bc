"""A tiny checkpoint of SAM 2.1 that outlines boxes as boxes, and keeps masks where they were.

Random masks would overlap each other nearly everywhere and leave a run without objects. So a few weights are set by
hand, the others are random and small: what is *outside* of an object is carried in channel 0 through the decoder and
through the memory, and a constant pattern in the other channels keeps the layers' normalisation from rescaling it.
"""

import math
from collections.abc import Iterable

import torch
from torch.nn import init
from transformers import Sam2VideoConfig, Sam2VideoModel

from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint, save_to_bytes

# Object pointers are cut into pieces of a memory's 64 channels, and two is the least that works.
WIDTH, MEMORY = 128, 64
SIDE, GRID = 128, 8
# How strongly `outside` shows in channel 0, and the part of it at which a mask ends.
OUTSIDE, _END = 4.0, 0.5
# Gain of the logits: masks are 0 or 1 when they are remembered.
_CERTAINTY = 5.0
# In channel 1 of memory, where object pointers are 0 and the encoding of places adds 1 at most.
_IS_MEMORY = 64.0
# What the mask's encoder makes of a cell within a mask and of one outside. The first is 0.36 where the cell is full; it
# is less here, so that small objects are not lost.
_CODE_INSIDE, _CODE_OUTSIDE = 0.25, -0.05


def make_sam2(seed: int) -> TinyCheckpoint:
    """Return the published network, half precision, with half the hidden channels, a small backbone and 128 px."""
    with torch.random.fork_rng(devices=()), torch.no_grad():
        torch.manual_seed(seed)
        model = Sam2VideoModel(_config()).eval()
        for name, tensor in model.state_dict().items():
            randomise(name, tensor)
        place_tokens(model, model.vision_encoder.neck.convs)
        compare_with_corners(model.mask_decoder.transformer.layers[0])
        show_inside(model)
        remember_masks(model.memory_encoder)
        look_up_masks(model.memory_attention.layers[0].cross_attn_image)
    return TinyCheckpoint(save_to_bytes(model.half()))


def _config() -> Sam2VideoConfig:
    backbone = {
        "model_type": "sam2_hiera_det_model",
        "hidden_size": 8,
        "image_size": [SIDE, SIDE],
        "blocks_per_stage": [1, 1, 2, 1],
        "embed_dim_per_stage": [8, 16, 24, 32],
        "num_attention_heads_per_stage": [1, 1, 1, 2],
        "window_size_per_stage": [8, 4, 4, 4],
        "global_attention_blocks": [3],
        "mlp_ratio": 2.0,
    }
    vision = {
        "model_type": "sam2_vision_model",
        "backbone_config": backbone,
        "backbone_channel_list": [32, 24, 16, 8],
        "backbone_feature_sizes": [[4 * GRID] * 2, [2 * GRID] * 2, [GRID] * 2],
        "fpn_hidden_size": WIDTH,
    }
    decoder = {
        "hidden_size": WIDTH,
        "mlp_dim": 16,
        "num_hidden_layers": 1,
        "num_attention_heads": 4,
        "attention_downsample_rate": 4,
        "iou_head_hidden_dim": 16,
    }
    return Sam2VideoConfig(
        vision_config=vision,
        prompt_encoder_config={"hidden_size": WIDTH, "image_size": SIDE, "mask_input_channels": 8},
        mask_decoder_config=decoder,
        image_size=SIDE,
        memory_attention_hidden_size=WIDTH,
        memory_attention_num_layers=1,
        memory_attention_downsample_rate=2,
        memory_attention_feed_forward_hidden_size=16,
        memory_attention_rope_feat_sizes=[GRID, GRID],
        memory_encoder_hidden_size=WIDTH,
        memory_encoder_output_channels=MEMORY,
        mask_downsampler_embed_dim=WIDTH,
        mask_downsampler_stride=4,
        mask_downsampler_kernel_size=4,
        mask_downsampler_padding=0,
        memory_fuser_num_layers=1,
        memory_fuser_embed_dim=WIDTH,
        memory_fuser_intermediate_dim=16,
    )


def randomise(name: str, tensor: torch.Tensor) -> None:
    """Set weights of unit gain in the backbone, of a small one elsewhere; no biases; initial normalisations."""
    if tensor.ndim > 1 and tensor.is_floating_point():
        gain = 1.0 if "backbone" in name else 0.05
        init.normal_(tensor, std=gain / max(tensor[0].numel(), 1) ** 0.5)
    elif "norm" not in name:
        init.zeros_(tensor)


def pattern(length: int, first: int) -> torch.Tensor:
    """Return +1 and -1 in turn from a channel on, 0 before it."""
    pattern = torch.ones(length)
    pattern[1::2] = -1
    pattern[:first] = 0
    return pattern


# Channels of a token: 0 and 1 its place, 2 which corner of a box; then whether it is a mask's or another token; then
# whether it is a corner.
_KIND, _IS_CORNER = slice(4, 64), slice(66, WIDTH)


def place_tokens(model: Sam2VideoModel, last_convolutions: Iterable[torch.nn.Conv2d]) -> None:
    """Encode positions by sines so slow that they are nearly linear; distinguish corners and other tokens.

    The two channels of places are kept free in the features that leave the `last_convolutions` of the image encoder.
    """
    for embedding in (model.shared_image_embedding, model.prompt_encoder.shared_embedding):
        embedding.positional_embedding.zero_()
        embedding.positional_embedding[0, 0] = embedding.positional_embedding[1, 1] = 1 / 16
    prompts, decoder = model.prompt_encoder, model.mask_decoder
    prompts.point_embed.weight.zero_()
    prompts.point_embed.weight[2, 2], prompts.point_embed.weight[3, 2] = 1, -1
    tokens = (prompts.not_a_point_embed, decoder.obj_score_token, decoder.iou_token, decoder.mask_tokens)
    for token in tokens:
        kinds = torch.randn(token.weight[:, _KIND].shape)
        token.weight.zero_()
        token.weight[:, _KIND] = kinds
    prompts.no_mask_embed.weight.zero_()
    model.no_memory_embedding[:] = pattern(model.no_memory_embedding.shape[-1], 2)
    for conv in last_convolutions:
        conv.weight[:2] = 0


def compare_with_corners(layer: torch.nn.Module) -> None:
    """Compute at each position of the image on how many sides it is outside the box.

    There is a head for each side: it attends to its corner if the position lies beyond it, else to other tokens.
    """
    kinds = pattern(WIDTH, 0)
    kinds[: _KIND.start] = kinds[_KIND.stop :] = 0
    # Self-attention first marks the corners: these attend to each other only, by their last channels.
    alike = layer.self_attn
    for projection in (alike.q_proj, alike.k_proj, alike.v_proj):
        projection.weight.copy_(torch.eye(WIDTH))
    num_flags = WIDTH - _IS_CORNER.start
    alike.o_proj.weight.zero_()
    alike.o_proj.weight[:, _IS_CORNER] = kinds[:, None] / num_flags
    alike.o_proj.bias[:] = -_END * kinds
    layer.layer_norm3.weight.copy_(kinds.abs())

    compare = layer.cross_attn_image_to_token
    for projection in (compare.q_proj, compare.k_proj, compare.v_proj, compare.o_proj):
        projection.weight.zero_()
    head_width = compare.head_dim
    # On a side the corner gets as much attention as the seven other tokens, half a cell beyond it nearly all.
    steepness, level = 40 * head_width**0.5, math.log(7) * head_width**0.5
    for head, (corner, axis) in enumerate(((1, 0), (1, 1), (-1, 0), (-1, 1))):
        place, other, one = head * head_width, head * head_width + 1, head * head_width + 2
        compare.q_proj.weight[place, axis] = corner
        compare.q_proj.weight[other, _IS_CORNER] = 1 / num_flags
        compare.q_proj.bias[one] = 1
        compare.k_proj.weight[place, _IS_CORNER] = -steepness / num_flags
        compare.k_proj.weight[other, axis] = corner * steepness
        compare.k_proj.weight[one, 2] = corner * steepness
        compare.k_proj.weight[one, _IS_CORNER] = (level - steepness) / num_flags
        compare.v_proj.weight[place] = kinds / (2 * (WIDTH * kinds.abs().sum()).sqrt())
        compare.v_proj.bias[place] = 0.5
        compare.o_proj.weight[0, place] = OUTSIDE


def show_inside(model: Sam2VideoModel) -> None:
    """Turn that number into the masks' logits, and mark every object as visible."""
    decoder = model.mask_decoder
    decoder.upscale_conv1.weight[0, 0] = 1
    decoder.upscale_conv1.bias.copy_(pattern(len(decoder.upscale_conv1.bias), 1))
    decoder.upscale_conv2.weight[0, 0] = 1
    decoder.upscale_conv2.bias[1] = OUTSIDE * _END
    for network in decoder.output_hypernetworks_mlps:
        network.proj_out.bias[0], network.proj_out.bias[1] = -_CERTAINTY, _CERTAINTY
    decoder.pred_obj_score_head.proj_out.bias.fill_(10)


def remember_masks(encoder: torch.nn.Module) -> None:
    """Store a mask in channel 0 of memory, with a constant that distinguishes memory from object pointers."""
    for layer in encoder.mask_downsampler.layers:
        layer.conv.weight[0, 0] = 1 / layer.conv.weight[0, 0].numel()
        layer.conv.bias.copy_(pattern(len(layer.conv.bias), 1))
    encoder.mask_downsampler.layers[0].conv.weight[0, 0] /= 10
    encoder.mask_downsampler.final_conv.weight[0, 0] = 1
    span = _CODE_INSIDE - _CODE_OUTSIDE
    encoder.projection.weight[0, 0] = 1 / span
    encoder.projection.bias[0], encoder.projection.bias[1] = -_CODE_OUTSIDE / span, _IS_MEMORY


def look_up_masks(attention: torch.nn.Module) -> None:
    """Read the memory at the same position, by the rotary encoding alone."""
    # The first sines of either axis, which turn fastest from place to place.
    alike = torch.zeros_like(attention.q_proj.bias).view(2, -1)
    alike[:, [0, 2, 4]] = 1
    alike = alike.flatten()
    for projection in (attention.q_proj, attention.k_proj, attention.v_proj, attention.o_proj):
        projection.weight.zero_()
    attention.q_proj.bias.copy_(80 * alike)
    attention.k_proj.weight[:, 1] = alike / _IS_MEMORY
    attention.v_proj.weight[0, 0], attention.v_proj.bias[0] = -1, 1
    attention.o_proj.weight[0, 0] = OUTSIDE
    attention.o_proj.bias.copy_(pattern(len(attention.o_proj.bias), 2))
