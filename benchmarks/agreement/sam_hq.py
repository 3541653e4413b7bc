"""Agreement of SAM-HQ's masks with those of the authors' code.

Run ``python benchmarks/agreement/sam_hq.py --official DIR``, DIR being a checkout of SysCV/sam-hq; neither torchvision
nor timm is needed. Both load the same random weights and get the same image and boxes. It prints the largest
differences as shares of the spread of what is compared, how far the authors' own masks move when the image changes in
the last digit, and what the ``forward`` of transformers makes of the same weights. Last, the authors' predictor and our
kernel on frames that are resized and padded: pixels of masks that differ.
"""

import argparse
import importlib
import re
import sys
import types
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import torch
import torchvision_parts
from transformers import SamHQConfig, SamHQModel

from moseg.schemas.parameters.sam_hq import SamHqParams
from moseg.tasks.instances.sam_hq import segment_boxes_sam_hq
from moseg.tasks.networks.sam_hq import decode_boxes, encode_image

BAR = 1e-3
SIDE = 256
VIT = {"embed_dim": 96, "depth": 4, "num_heads": 4, "global_attn_indexes": [1, 3], "window_size": 6}
# Published names of tensors to the authors', applied one after the other.
NAMES = (
    (r"^vision_encoder\.", "image_encoder."),
    (r"^image_encoder\.layers\.", "image_encoder.blocks."),
    (r"patch_embed\.projection", "patch_embed.proj"),
    (r"neck\.conv1", "neck.0"),
    (r"neck\.layer_norm1", "neck.1"),
    (r"neck\.conv2", "neck.2"),
    (r"neck\.layer_norm2", "neck.3"),
    (r"mask_embed\.conv1", "mask_downscaling.0"),
    (r"mask_embed\.layer_norm1", "mask_downscaling.1"),
    (r"mask_embed\.conv2", "mask_downscaling.3"),
    (r"mask_embed\.layer_norm2", "mask_downscaling.4"),
    (r"mask_embed\.conv3", "mask_downscaling.6"),
    (r"prompt_encoder\.point_embed", "prompt_encoder.point_embeddings"),
    (r"shared_embedding\.positional_embedding", "pe_layer.positional_encoding_gaussian_matrix"),
    (r"upscale_conv1", "output_upscaling.0"),
    (r"upscale_layer_norm", "output_upscaling.1"),
    (r"upscale_conv2", "output_upscaling.3"),
    (r"compress_vit_conv1", "compress_vit_feat.0"),
    (r"compress_vit_norm", "compress_vit_feat.1"),
    (r"compress_vit_conv2", "compress_vit_feat.3"),
    (r"encoder_conv1", "embedding_encoder.0"),
    (r"encoder_norm", "embedding_encoder.1"),
    (r"encoder_conv2", "embedding_encoder.3"),
    (r"mask_conv1", "embedding_maskfeature.0"),
    (r"mask_norm", "embedding_maskfeature.1"),
    (r"mask_conv2", "embedding_maskfeature.3"),
    (r"hq_token", "hf_token"),
    (r"hq_mask_mlp", "hf_mlp"),
    (r"((?:mlps\.\d+|hf_mlp|iou_prediction_head)\.)layers\.0", r"\1layers.1"),
    (r"((?:mlps\.\d+|hf_mlp|iou_prediction_head)\.)proj_in", r"\1layers.0"),
    (r"((?:mlps\.\d+|hf_mlp|iou_prediction_head)\.)proj_out", r"\1layers.2"),
    (r"layer_norm", "norm"),
)


def build_official(folder: Path) -> torch.nn.Module:
    """Return the authors' network, of the same small size."""
    # Each module is imported alone, because their packages import torchvision and timm for parts not needed here.
    for name in ("segment_anything", "segment_anything.modeling"):
        sys.modules[name] = types.ModuleType(name)
        sys.modules[name].__path__ = [str(folder.joinpath(*name.split(".")))]
    image, prompt, decoder, transformer, sam = (
        importlib.import_module(f"segment_anything.modeling.{name}")
        for name in ("image_encoder", "prompt_encoder", "mask_decoder_hq", "transformer", "sam")
    )
    places = SIDE // 16
    return sam.Sam(
        image_encoder=image.ImageEncoderViT(
            img_size=SIDE,
            norm_layer=partial(torch.nn.LayerNorm, eps=1e-6),
            use_rel_pos=True,
            **VIT,
        ),
        prompt_encoder=prompt.PromptEncoder(256, (places, places), (SIDE, SIDE), mask_in_chans=16),
        mask_decoder=decoder.MaskDecoderHQ(
            transformer=transformer.TwoWayTransformer(depth=2, embedding_dim=256, mlp_dim=2048, num_heads=8),
            transformer_dim=256,
            vit_dim=VIT["embed_dim"],
        ),
    ).eval()


def build_ours() -> SamHQModel:
    """Return our network with nonzero random weights."""
    config = SamHQConfig(
        vision_config={
            "hidden_size": VIT["embed_dim"],
            "num_hidden_layers": VIT["depth"],
            "num_attention_heads": VIT["num_heads"],
            "global_attn_indexes": VIT["global_attn_indexes"],
            "window_size": VIT["window_size"],
            "image_size": SIDE,
        },
        prompt_encoder_config={"image_size": SIDE},
        mask_decoder_config={"vit_dim": VIT["embed_dim"]},
    )
    model = SamHQModel(config).eval().requires_grad_(False)
    for name, value in model.named_parameters():
        spread = 1.0 if value.ndim < 2 or "token" in name or "embed" in name else value[0].numel() ** -0.5
        value.normal_(std=spread).add_(1.0 if "norm" in name and name.endswith("weight") else 0.0)
    return model


def copy_weights(model: SamHQModel, official: torch.nn.Module) -> None:
    tensors = {}
    for name, value in model.state_dict().items():
        for pattern, replacement in NAMES:
            name = re.sub(pattern, replacement, name)
        tensors[name] = value
    del tensors["shared_image_embedding.positional_embedding"]
    official.load_state_dict(tensors)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of SysCV/sam-hq")
    folder = parser.parse_args().official
    torch.set_num_threads(1)
    torch.manual_seed(0)
    with torch.inference_mode():
        model, official = build_ours(), build_official(folder)
        copy_weights(model, official)
        worst = max(compare(model, official), compare_frames(model, official))
        sys.exit(0 if worst <= BAR else 1)


def compare_frames(model: SamHQModel, official: torch.nn.Module) -> float:
    """Return the larger of the share of differing pixels and the difference of quality (an IoU), from the frame on."""
    torchvision_parts.stand_in()
    sys.modules["segment_anything.modeling"].Sam = type(official)
    predictor = importlib.import_module("segment_anything.predictor").SamPredictor(official)
    worst = 0.0
    for height, width in ((240, 427), (300, 200)):
        frame = cv2.GaussianBlur(np.random.default_rng(0).normal(size=(height, width, 3)), (0, 0), 5)
        frame = (127 + 1000 * frame).clip(0, 255).astype(np.uint8)
        boxes = np.array([[0.1, 0.1, 0.5, 0.8], [0.3, 0.2, 0.95, 0.5], [-0.05, 0, 0.6, 1.02]], np.float32)
        boxes *= np.float32([width, height] * 2)
        predictor.set_image(frame)
        asked = predictor.transform.apply_boxes_torch(torch.from_numpy(boxes), frame.shape[:2])
        wanted, wanted_quality, _ = predictor.predict_torch(None, None, boxes=asked, multimask_output=False)
        masks, quality = segment_boxes_sam_hq(model, frame, boxes, SamHqParams())
        figures = np.mean(masks != wanted[:, 0].numpy()), np.abs(quality - wanted_quality[:, 0].numpy()).max()
        print(f"{width}x{height:<12} {figures[1]:17.1e} {figures[0]:29.1e} end to end, {masks.mean():.0%} inside")
        worst = max(worst, *figures)
    return worst


def compare(model: SamHQModel, official: torch.nn.Module) -> float:
    """Return the largest of the printed differences."""
    pixels = torch.randn(1, 3, SIDE, SIDE)
    boxes = torch.tensor([[10.0, 20, 100, 200], [50, 60, 250, 130], [0, 0, 255, 255]])
    features = encode_image(model, pixels)
    worst = 0.0
    print(f"{'':16} {'logits':>8} {'quality':>8} {'one ulp':>8} {'pixels that differ':>19} {'by forward':>11}")
    for hq_token_only in (False, True):
        wanted, wanted_quality = run_official(official, pixels, boxes, hq_token_only)
        logits, quality = decode_boxes(model, features, boxes, hq_token_only)
        nudged, _ = run_official(official, pixels * (1 + torch.finfo(pixels.dtype).eps), boxes, hq_token_only)
        forward = model(
            pixel_values=pixels, input_boxes=boxes[None], multimask_output=False, hq_token_only=hq_token_only
        ).pred_masks[0, :, 0]
        figures = [share(logits, wanted), share(quality, wanted_quality), share(nudged, wanted)]
        changed, changed_forward = (((found > 0) != (wanted > 0)).float().mean().item() for found in (logits, forward))
        name = "token alone" if hq_token_only else "both tokens"
        print(f"{name:16}", *(f"{value:8.1e}" for value in figures), f"{changed:19.1e} {changed_forward:11.1e}")
        worst = max(worst, *figures[:2])
    return worst


def run_official(official: torch.nn.Module, pixels, boxes, hq_token_only: bool) -> tuple[torch.Tensor, torch.Tensor]:
    """Return the authors' logits (n, y, x) and quality (n,)."""
    embedding, layers = official.image_encoder(pixels)
    corners, dense = official.prompt_encoder(points=None, boxes=boxes, masks=None)
    logits, quality = official.mask_decoder(
        image_embeddings=embedding,
        image_pe=official.prompt_encoder.get_dense_pe(),
        sparse_prompt_embeddings=corners,
        dense_prompt_embeddings=dense,
        multimask_output=False,
        hq_token_only=hq_token_only,
        interm_embeddings=layers,
    )
    return logits[:, 0], quality[:, 0]


def share(found: torch.Tensor, wanted: torch.Tensor) -> float:
    """Return the largest difference as a share of the spread of the expected values."""
    return ((found - wanted).abs().max() / wanted.std()).item()


if __name__ == "__main__":
    main()
