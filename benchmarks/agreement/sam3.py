"""Agreement of SAM 3 by transformers, as our kernels run it, with the authors' code.

Run ``python benchmarks/agreement/sam3.py --official DIR``, DIR being a checkout of facebookresearch/sam3; none of
torchvision, timm, iopath, ftfy and triton is needed. The image encoder, the text encoder and the input are small; the
detector and the tracker are as published. The detector's logits, boxes and masks are compared, and the objects that
either code finds by a phrase if it reads and resizes the frame itself; so are the tracker's logits and labels.
"""

import argparse
import contextlib
import importlib
import json
import re
import sys
import types
import warnings
from pathlib import Path
from unittest import mock

import cv2
import numpy as np
import sam2_family
import torch
import torchvision_parts
from PIL import Image
from sam2_family import BAR, WIDE, Masks, double_precision, moving_discs, report
from transformers import Sam3VideoConfig, Sam3VideoModel

from moseg.schemas.parameters.sam3 import Sam3Params
from moseg.tasks.instances.sam3 import segment_concepts
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.frame_tensor import SYMMETRIC, Resizing, frame_tensor
from moseg.tasks.networks.sam3 import Sam3Detector, build_sam3_detector, build_sam3_tracker
from moseg.tasks.proposals.sam2 import track_masks_sam2

GRID, PATCH = 16, 14
SIDE = GRID * PATCH
WIDTH, HEADS, WINDOW, LAYERS, GLOBAL = 64, 4, 8, 4, (1, 3)
TEXT = {"width": 64, "heads": 4, "layers": 3}
SHARE_FOUND = 0.03
PHRASES = ("person", "sports ball", "a person's red hat", "Yellow  school bus", "crème brûlée, 2 of 3")
# Names of transformers to the authors', applied one after the other.
DETECTOR = (
    (r"^vision_encoder\.backbone\.", "backbone.vision_backbone.trunk."),
    (r"^vision_encoder\.neck\.fpn_layers\.", "backbone.vision_backbone.convs."),
    (r"embeddings\.position_embeddings", "pos_embed"),
    (r"embeddings\.patch_embeddings\.projection", "patch_embed.proj"),
    (r"trunk\.layer_norm", "trunk.ln_pre"),
    (r"trunk\.layers\.", "trunk.blocks."),
    (r"(blocks\.\d+\.)layer_norm", r"\1norm"),
    (r"(blocks\.\d+\.)attention\.o_proj", r"\1attn.proj"),
    (r"(blocks\.\d+\.)attention\.", r"\1attn."),
    (r"convs\.0\.scale_layers\.0", "convs.0.dconv_2x2_0"),
    (r"convs\.0\.scale_layers\.2", "convs.0.dconv_2x2_1"),
    (r"convs\.1\.scale_layers\.0", "convs.1.dconv_2x2"),
    (r"(convs\.\d\.)proj1", r"\1conv_1x1"),
    (r"(convs\.\d\.)proj2", r"\1conv_3x3"),
    (r"^text_encoder\.(text_model\.)?", "backbone.language_backbone.encoder."),
    (r"embeddings\.token_embedding", "token_embedding"),
    (r"embeddings\.position_embedding\.weight", "positional_embedding"),
    (r"final_layer_norm", "ln_final"),
    (r"encoder\.encoder\.layers\.", "encoder.transformer.resblocks."),
    (r"(resblocks\.\d+\.)layer_norm", r"\1ln_"),
    (r"(resblocks\.\d+\.)self_attn", r"\1attn"),
    (r"(resblocks\.\d+\.)mlp\.fc1", r"\1mlp.c_fc"),
    (r"(resblocks\.\d+\.)mlp\.fc2", r"\1mlp.c_proj"),
    (r"^text_projection\.", "backbone.language_backbone.resizer."),
    (r"^geometry_encoder\.layers\.", "geometry_encoder.encode."),
    (r"vision_layer_norm", "img_pre_norm"),
    (r"prompt_layer_norm", "norm"),
    (r"^geometry_encoder\.output_layer_norm", "geometry_encoder.encode_norm"),
    (r"^detr_encoder\.", "transformer.encoder."),
    (r"((?:encode|encoder\.layers)\.\d+\.)cross_attn", r"\1cross_attn_image"),
    (r"((?:encode|encoder\.layers)\.\d+\.)layer_norm", r"\1norm"),
    (r"^detr_decoder\.", "transformer.decoder."),
    (r"decoder\.output_layer_norm", "decoder.norm"),
    (r"presence_layer_norm", "presence_token_out_norm"),
    (r"presence_head", "presence_token_head"),
    (r"box_head", "bbox_embed"),
    (r"box_rpb_embed", "boxRPB_embed"),
    (r"(decoder\.layers\.\d+\.)vision_cross_attn_layer_norm", r"\1norm1"),
    (r"(decoder\.layers\.\d+\.)text_cross_attn_layer_norm", r"\1catext_norm"),
    (r"(decoder\.layers\.\d+\.)self_attn_layer_norm", r"\1norm2"),
    (r"(decoder\.layers\.\d+\.)mlp_layer_norm", r"\1norm3"),
    (r"(decoder\.layers\.\d+\.)vision_cross_attn", r"\1cross_attn"),
    (r"(decoder\.layers\.\d+\.)text_cross_attn", r"\1ca_text"),
    (r"((?:encode|layers)\.\d+\.)mlp\.fc", r"\1linear"),
    (r"^dot_product_scoring\.text_mlp_out_norm", "dot_prod_scoring.prompt_mlp.out_norm"),
    (r"^dot_product_scoring\.text_mlp", "dot_prod_scoring.prompt_mlp"),
    (r"^dot_product_scoring\.text_proj", "dot_prod_scoring.prompt_proj"),
    (r"^dot_product_scoring\.query_proj", "dot_prod_scoring.hs_proj"),
    (r"^mask_decoder\.mask_embedder", "segmentation_head.mask_predictor.mask_embed"),
    (r"^mask_decoder\.instance_projection", "segmentation_head.instance_seg_head"),
    (r"^mask_decoder\.semantic_projection", "segmentation_head.semantic_seg_head"),
    (r"^mask_decoder\.prompt_cross_attn_norm", "segmentation_head.cross_attn_norm"),
    (r"^mask_decoder\.prompt_cross_attn", "segmentation_head.cross_attend_prompt"),
    (r"^mask_decoder\.", "segmentation_head."),
    (r"\.layer(\d)\.", lambda found: f".layers.{int(found[1]) - 1}."),
    (r"\.o_proj\.", ".out_proj."),
)
# Names of SAM 2's authors to those of SAM 3.
TRACKER = (
    (r"^memory_attention\.", "transformer.encoder."),
    (r"^memory_encoder\.", "maskmem_backbone."),
    (r"(mask_decoder\.transformer\.layers\.\d\.mlp\.)layers\.0", r"\1lin1"),
    (r"(mask_decoder\.transformer\.layers\.\d\.mlp\.)layers\.1", r"\1lin2"),
)


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


def official_detector(state: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return the detector's tensors under the authors' names; attention has one matrix there for its three inputs."""
    tensors = {_renamed(name, DETECTOR): value for name, value in state.items()}
    for name in [name for name in tensors if ".q_proj." in name]:
        parts = [tensors.pop(name.replace(".q_proj.", f".{part}_proj.")) for part in "qkv"]
        stem, kind = name.split(".q_proj.")
        joined = f"{stem}.qkv.{kind}" if "trunk" in name else f"{stem}.in_proj_{kind}"
        tensors[joined] = torch.cat(parts)
    # Theirs also has a place for a token that they drop.
    name = "backbone.vision_backbone.trunk.pos_embed"
    tensors[name] = torch.cat([torch.zeros(1, 1, WIDTH), tensors[name]], dim=1)
    del tensors["backbone.language_backbone.encoder.text_projection.weight"]
    return tensors


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
    trunk = {name: value for name, value in detector.state_dict().items() if ".vision_backbone." in name}
    for name, value in parts["tracker_neck."].items():
        name = _renamed(f"vision_encoder.neck.{name}", DETECTOR)
        trunk[name.replace(".convs.", ".sam2_convs.")] = value
    named = sam2_family.official_names(parts["tracker_model."])
    named = {_renamed(name, TRACKER): value for name, value in named.items()}
    _load(tracker, named | trunk)
    return detector, tracker


def _renamed(name: str, names) -> str:
    for pattern, replacement in names:
        name = re.sub(pattern, replacement, name)
    return name


def _with(make, values: dict):
    return lambda *args, **given: make(*args, **(given | values))


def _load(model: torch.nn.Module, tensors: dict[str, torch.Tensor]) -> None:
    """Load tensors; what is missing or left over may only be rotations, points as prompts and an unused projection."""
    found = model.load_state_dict(tensors, strict=False)
    unset = [name for name in found.missing_keys if not re.search(r"freqs_cis|points_|text_projection", name)]
    if unset or found.unexpected_keys:
        raise SystemExit(f"missing: {unset[:9]}\nleft over: {found.unexpected_keys[:9]}")


def our_checkpoint(state: dict[str, torch.Tensor], tokenizer) -> Checkpoint:
    """Return the checkpoint of these weights, with the authors' tokens under CLIP's names."""
    names = {"<start_of_text>": "<|startoftext|>", "<end_of_text>": "<|endoftext|>"}
    documents = {
        "config.json": our_config().to_json_string(use_diff=False),
        "vocab.json": json.dumps({names.get(token, token): number for token, number in tokenizer.encoder.items()}),
        "merges.txt": "".join(f"{line}\n" for line in ("#version: 0.2", *map(" ".join, tokenizer.bpe_ranks))),
    }
    return Checkpoint("random", state, documents)


def compare_tokens(tokenizer, detector: Sam3Detector) -> bool:
    """Return whether both codes make the same tokens of the phrases."""
    agrees = True
    for phrase in PHRASES:
        theirs = [token for token in tokenizer([phrase], context_length=32)[0].tolist() if token]
        agrees &= theirs == detector.tokenize(" ".join(phrase.lower().split()))
    print(f"tokens of {len(PHRASES)} phrases: {'the same' if agrees else 'DIFFERENT'}", flush=True)
    return agrees


def official_answer(official, pixels: torch.Tensor, phrase: str) -> dict[str, torch.Tensor]:
    """Return the authors' answer about normalised pixels."""
    stage = importlib.import_module("sam3.model.sam3_image_processor").FindStage
    none = dict.fromkeys(("input_boxes", "input_boxes_mask", "input_boxes_label", "input_points", "input_points_mask"))
    first = torch.tensor([0])
    seen = official.backbone.forward_image(pixels) | official.backbone.forward_text([phrase], device="cpu")
    return official.forward_grounding(
        seen, stage(img_ids=first, text_ids=first, **none), None, official._get_dummy_prompt()
    )


def compare_answers(official, detector: Sam3Detector, frame: np.ndarray) -> bool:
    """Return whether the detectors agree, and print how far transformers' own answer to a phrase is from theirs."""
    pixels = frame_tensor(frame, (SIDE, SIDE), torch.device("cpu"), normalisation=SYMMETRIC)
    vision = detector.model.get_vision_features(pixels)
    worst = np.zeros((3, 3))
    for phrase in PHRASES:
        wanted, nudged = (
            official_answer(official, images, phrase)
            for images in (pixels, pixels * (1 + torch.finfo(pixels.dtype).eps))
        )
        tokens = torch.tensor([detector.tokenize(phrase)])
        plain = detector.model(vision_embeds=vision, input_ids=tokens, attention_mask=torch.ones_like(tokens))
        for row, kind in enumerate(("pred_logits", "pred_boxes_xyxy", "pred_masks")):
            theirs = wanted[kind][0].squeeze(-1) if row == 0 else wanted[kind][0]
            other = nudged[kind][0].reshape(theirs.shape)
            ours = [getattr(found, kind.removesuffix("_xyxy"))[0] for found in (detector.find(vision, phrase), plain)]
            found = [(value - theirs).abs().max() / theirs.std() for value in (*ours, other)]
            worst[row] = np.maximum(worst[row], [value.item() for value in found])
    for kind, (ours, plain, nudge) in zip(("scores", "boxes", "masks"), worst, strict=True):
        print(f"detector, {kind:7} ours {ours:.1e}, transformers {plain:.1e}, one ulp {nudge:.1e}", flush=True)
    return bool((worst[:, 0] <= np.maximum(BAR, worst[:, 2])).all())


def compare_found(official, detector: Sam3Detector, frame: np.ndarray) -> bool:
    """Compare the objects if each code reads and resizes the frame itself; return whether they agree."""
    processor = importlib.import_module("sam3.model.sam3_image_processor").Sam3Processor(official, SIDE, "cpu", 0.0)
    state = processor.set_image(Image.fromarray(frame))
    # Random weights score low.
    scores = torch.cat([processor.set_text_prompt(phrase, state)["scores"] for phrase in PHRASES])
    params = Sam3Params(min_score=scores.quantile(1 - SHARE_FOUND).item())
    processor.set_confidence_threshold(params.min_score)
    same, changed, difference, num_found, num_pixels = True, 0, 0.0, 0, 0
    for phrase in PHRASES:
        wanted = processor.set_text_prompt(phrase, state)
        found = segment_concepts(detector, frame, [phrase], params)
        theirs, scores = wanted["masks"][:, 0].numpy(), wanted["scores"].numpy()
        num_found += len(theirs)
        if len(theirs) != len(found.masks):
            same = False
            continue
        changed += int(np.count_nonzero(theirs != found.masks))
        num_pixels += theirs.size
        difference = max(difference, float(np.abs(found.scores - scores).max(initial=0)))
    print(
        f"objects, end to end: {num_found} by {len(PHRASES)} phrases, {'the same' if same else 'OTHERS'}; {changed} of "
        f"{num_pixels} pixels of masks differ, scores by {difference:.1e}",
        flush=True,
    )
    return same and num_found > 0 and changed <= 1e-3 * num_pixels and difference <= 1e-3


def official_video(official, pixels: torch.Tensor, size: tuple[int, int], seeds: np.ndarray) -> Masks:
    """Return the objects tracked by the authors' predictor in normalised pixels (frame, 3, y, x)."""
    state = official.init_state(*size, len(pixels), offload_state_to_cpu=True)
    state["images"] = pixels
    for label in (1, 2):
        official.add_new_mask(state, 0, label, torch.from_numpy(seeds == label))
    labels, logits, scores = [], [], []
    for found in official.propagate_in_video(state, 0, len(pixels), False, tqdm_disable=True, propagate_preflight=True):
        _, _, small, masks, score = found
        surest, index = masks[:, 0].max(dim=0)
        labels.append(torch.where(surest > 0, index + 1, 0).numpy())
        logits.append(small[:, 0])
        scores.append(score[:, 0])
    return Masks(torch.cat(logits[1:]), torch.cat(scores[1:]), np.stack(labels)[1:])


def our_video(tracker: torch.nn.Module, frames: list[np.ndarray], seeds: np.ndarray) -> Masks:
    """Return the objects tracked by our kernel."""
    outputs = []
    with tracker.register_forward_hook(lambda _module, _inputs, output: outputs.append(output)):
        labels = track_masks_sam2(tracker, frames, seeds, Sam3Params())
    logits = torch.cat([output.pred_masks for output in outputs[1:]])[:, 0]
    return Masks(logits, torch.cat([output.object_score_logits for output in outputs[1:]])[:, 0], labels[1:])


def compare_videos(official, tracker: torch.nn.Module, frames: list[np.ndarray], seeds: np.ndarray) -> bool:
    """Return whether the trackers agree; theirs gets frames that are resized like those of a folder of theirs."""
    device = torch.device("cpu")
    pixels = [frame_tensor(frame, (SIDE, SIDE), device, Resizing.PIL_BICUBIC, SYMMETRIC) for frame in frames]
    pixels = torch.cat(pixels)
    print(f"{'':14} {'logits':>9} {'scores':>9} {'one ulp':>9} {'pixels':>8} {'one ulp':>8} {'seen':>6}")
    theirs, nudged = (
        official_video(official, images, seeds.shape, seeds)
        for images in (pixels, pixels * (1 + torch.finfo(pixels.dtype).eps))
    )
    return report("video", our_video(tracker, frames, seeds), theirs, nudged)


def compare(folder: Path) -> bool:
    """Return whether our networks agree with the authors' code in a folder."""
    builder = import_official(folder)
    state = random_state()
    official, official_tracker = build_official(builder, folder, state)
    tokenizer = official.backbone.language_backbone.tokenizer
    checkpoint = our_checkpoint(state, tokenizer)
    detector = build_sam3_detector(checkpoint)
    frames, seeds = moving_discs(16)
    frames = [cv2.resize(frame, WIDE) for frame in frames]
    seeds = cv2.resize(seeds, WIDE, interpolation=cv2.INTER_NEAREST)
    agrees = compare_tokens(tokenizer, detector)
    agrees &= compare_answers(official, detector, frames[0])
    agrees &= compare_found(official, detector, frames[0])
    return compare_videos(official_tracker, build_sam3_tracker(checkpoint), frames, seeds) and agrees


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of facebookresearch/sam3")
    folder = parser.parse_args().official
    torch.set_num_threads(1)
    warnings.simplefilter("ignore")
    itself = {name: lambda tensor, *_, **__: tensor for name in ("cuda", "pin_memory")}
    with torch.inference_mode(), double_precision(), mock.patch.multiple(torch.Tensor, **itself):
        torch.manual_seed(0)
        return 0 if compare(folder) else 1


if __name__ == "__main__":
    sys.exit(main())
