"""A tiny SAM-HQ whose masks fill the boxes, with edges that follow the image a little."""

import json

import torch
from transformers import SamHQConfig, SamHQModel

from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint, save_to_bytes

_SIDE = 128
_PATCH = 8
_WIDTH = 32
_HEADS = 4
_VIT_WIDTH = 16
# Channels with a meaning; the others are random. A place is the sine and cosine of half a turn across the frame.
_SIN_X, _SIN_Y, _COS_X, _COS_Y = 0, 1, 16, 17
_FIRST, _SECOND, _OTHER, _OUTSIDE = 12, 13, 14, 15
_FLAG = 8.0
_SHARPNESS = 80.0
_IGNORED = -8.0
# Between what the attention yields for a pixel inside, and for one that lies outside on one side.
_ONE_SIDE = 1.1


def make_sam_hq(seed: int) -> TinyCheckpoint:
    """Return files of ``syscv-community/sam-hq-vit-base``, random except for the path from a box to its mask."""
    config = SamHQConfig(
        vision_config={
            "hidden_size": _VIT_WIDTH,
            "output_channels": _WIDTH,
            "num_hidden_layers": 2,
            "num_attention_heads": 2,
            "image_size": _SIDE,
            "patch_size": _PATCH,
            "window_size": 4,
            "global_attn_indexes": [1],
            "num_pos_feats": _WIDTH // 2,
            "mlp_dim": 32,
            "initializer_range": 0.3,
        },
        prompt_encoder_config={"hidden_size": _WIDTH, "image_size": _SIDE, "patch_size": _PATCH},
        mask_decoder_config={
            "hidden_size": _WIDTH,
            "mlp_dim": 32,
            "num_hidden_layers": 1,
            "num_attention_heads": _HEADS,
            "iou_head_hidden_dim": _WIDTH,
            "vit_dim": _VIT_WIDTH,
        },
    )
    with torch.random.fork_rng(devices=[]), torch.no_grad():
        torch.manual_seed(seed)
        model = SamHQModel(config)
        _flag_tokens(model)
        _attend_to_corners(model.mask_decoder.transformer.layers[0])
        _decode_outside(model.mask_decoder)
    preprocessor = {
        "image_processor_type": "SamImageProcessor",
        "size": {"longest_edge": _SIDE},
        "pad_size": {"height": _SIDE, "width": _SIDE},
    }
    return TinyCheckpoint(save_to_bytes(model) | {"preprocessor_config.json": json.dumps(preprocessor).encode()})


def _flag_tokens(model: SamHQModel) -> None:
    """Mark the tokens: a box's first corner, its second one, and mask tokens; encode x and y in order."""
    places = model.shared_image_embedding.positional_embedding
    places[:, :2] = torch.eye(2) / 8
    places[:, _FIRST:] = 0
    model.prompt_encoder.shared_embedding.positional_embedding.copy_(places)
    prompt, decoder = model.prompt_encoder, model.mask_decoder
    prompt.point_embed[2].weight[0, _FIRST] = _FLAG
    prompt.point_embed[3].weight[0, _SECOND] = _FLAG
    for tokens in (decoder.iou_token, decoder.mask_tokens, decoder.hq_token):
        tokens.weight[:, _OTHER] = _FLAG
    # The image's own features are small beside the places, but for two channels that keep its layer norm steady.
    model.vision_encoder.neck.layer_norm2.weight.fill_(0.03)
    prompt.no_mask_embed.weight.zero_()
    prompt.no_mask_embed.weight[0, 2:4] = torch.tensor([4.0, -4.0])


def _attend_to_corners(layer: torch.nn.Module) -> None:
    """Compute at each pixel on how many sides it lies outside the box.

    Each of the four heads of the attention from image to tokens is for one side: it compares the pixel's position
    with one corner by the sine of their difference, and attends to that corner if the pixel lies beyond it, else to the
    mask tokens. Corners have the value 1, others 0.
    """
    for attention in (layer.self_attn, layer.cross_attn_token_to_image, layer.cross_attn_image_to_token):
        for projection in (attention.q_proj, attention.k_proj, attention.v_proj, attention.out_proj):
            projection.weight.zero_()
            projection.bias.zero_()
    layer.mlp.lin2.weight.zero_()
    layer.mlp.lin2.bias.zero_()

    alike = layer.self_attn
    alike.v_proj.weight.copy_(torch.eye(_WIDTH))
    alike.out_proj.weight.copy_(torch.eye(_WIDTH))
    # Behind the first block a token keeps its flag only: places come to the keys once more as prompts.
    layer.layer_norm3.weight.zero_()
    layer.layer_norm3.weight[_FIRST : _OTHER + 1] = 1
    outside = layer.cross_attn_image_to_token
    corners = (_FIRST, _SECOND)
    sides = [(corner, sin, cos) for corner in corners for sin, cos in ((_SIN_X, _COS_X), (_SIN_Y, _COS_Y))]
    for head, (corner, sin, cos) in enumerate(sides):
        at = head * _WIDTH // _HEADS
        for channel, flag in enumerate((_FIRST, _SECOND, _OTHER), start=at):
            alike.q_proj.weight[channel, flag] = alike.k_proj.weight[channel, flag] = 1
        at //= 2  # between image and tokens, attention works on half the channels
        sign = _SHARPNESS if corner == _FIRST else -_SHARPNESS
        outside.q_proj.weight[at, cos] = outside.q_proj.weight[at + 1, sin] = outside.q_proj.bias[at + 2] = 1
        outside.k_proj.weight[at, sin], outside.k_proj.weight[at + 1, cos] = sign, -sign
        (ignored,) = set(corners) - {corner}
        outside.k_proj.weight[at + 2, ignored] = _IGNORED
        outside.v_proj.weight[at, [_FIRST, _SECOND]] = 1
        outside.out_proj.weight[_OUTSIDE, at] = 1


def _decode_outside(decoder: torch.nn.Module) -> None:
    """Decode the pixels that are outside on no side as the mask, and correct it by the image's features.

    Inside and outside are carried as a pair of opposite channels, which GELU leaves whole: gelu(x) - gelu(-x) = x.
    """
    pair = torch.tensor([1.0, -1.0])
    first, second = decoder.upscale_conv1, decoder.upscale_conv2
    first.weight.zero_()
    first.weight[_OUTSIDE, :2] = -pair[:, None, None]
    # Two more channels keep the layer norm in between steady.
    first.bias[:4] = torch.cat([_ONE_SIDE * pair, 6 * pair])
    second.weight[:2, :2] = torch.outer(pair, pair)[:, :, None, None]
    second.weight[2:].zero_()
    second.bias.zero_()
    for head in decoder.output_hypernetworks_mlps:
        head.proj_out.bias[:2] = 3 * pair
    for conv in (decoder.encoder_conv2, decoder.compress_vit_conv2):
        conv.weight.normal_(std=0.5)
    decoder.hq_mask_mlp.proj_out.bias.normal_(std=0.5)
    decoder.iou_prediction_head.proj_out.bias.fill_(0.9)
