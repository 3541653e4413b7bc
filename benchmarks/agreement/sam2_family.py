"""Shared parts of the comparisons of SAM 2.1 and EdgeTAM, whose authors' code is the same but for the networks."""

import argparse
import importlib
import re
import sys
import tempfile
import types
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import cv2
import numpy as np
import torch
import torchvision_parts
import yaml
from PIL import Image
from torch.nn import functional

from moseg.schemas.parameters.sam2 import Sam2Params
from moseg.tasks.instances.sam2 import segment_boxes_sam2
from moseg.tasks.networks.frame_tensor import frame_tensor
from moseg.tasks.proposals.sam2 import track_masks_sam2

BAR = 1e-6
SIDE, GRID = 256, 16
WIDE = (427, 240)
NUM_FRAMES = 20
BOXES = np.array([[10, 20, 100, 200], [50, 60, 250, 130], [0, 0, 255, 255], [120, 100, 180, 220]], np.float32)
SCORE_BIAS = "mask_decoder.pred_obj_score_head.proj_out.bias"
NOT_SEEN = -1024.0
# Published names of tensors to the authors', applied one after the other.
NAMES = (
    (r"^vision_encoder\.backbone\.", "image_encoder.trunk."),
    (r"^vision_encoder\.neck\.convs\.(\d)\.", r"image_encoder.neck.convs.\1.conv."),
    (r"patch_embed\.projection", "patch_embed.proj"),
    (r"((?:blocks|layers)\.\d+\.mlp)\.proj_in", r"\1.layers.0"),
    (r"((?:blocks|layers)\.\d+\.mlp)\.proj_out", r"\1.layers.1"),
    (r"((?:mlps\.\d+|head|pointer_proj)\.)layers\.0", r"\1layers.1"),
    (r"((?:mlps\.\d+|head|pointer_proj)\.)proj_in", r"\1layers.0"),
    (r"((?:mlps\.\d+|head|pointer_proj)\.)proj_out", r"\1layers.2"),
    (r"mask_embed\.conv1", "mask_downscaling.0"),
    (r"mask_embed\.layer_norm1", "mask_downscaling.1"),
    (r"mask_embed\.conv2", "mask_downscaling.3"),
    (r"mask_embed\.layer_norm2", "mask_downscaling.4"),
    (r"mask_embed\.conv3", "mask_downscaling.6"),
    (r"shared_embedding\.positional_embedding", "pe_layer.positional_encoding_gaussian_matrix"),
    (r"upscale_conv1", "output_upscaling.0"),
    (r"upscale_layer_norm", "output_upscaling.1"),
    (r"upscale_conv2", "output_upscaling.3"),
    (r"mask_downsampler\.layers\.(\d)\.conv", lambda found: f"mask_downsampler.encoder.{3 * int(found[1])}"),
    (r"mask_downsampler\.layers\.(\d)\.layer_norm", lambda found: f"mask_downsampler.encoder.{3 * int(found[1]) + 1}"),
    (r"mask_downsampler\.final_conv", "mask_downsampler.encoder.12"),
    (r"^memory_encoder\.feature_projection", "memory_encoder.pix_feat_proj"),
    (r"^memory_encoder\.projection", "memory_encoder.out_proj"),
    (r"^memory_encoder\.memory_fuser", "memory_encoder.fuser"),
    (r"fuser\.layers\.(\d)\.scale", r"fuser.layers.\1.gamma"),
    (r"depthwise_conv", "dwconv"),
    (r"pointwise_conv", "pwconv"),
    (r"layer_norm_final_attn", "norm_final_attn"),
    (r"layer_norm", "norm"),
    (r"\.o_proj\.", ".out_proj."),
    (r"^prompt_encoder\.", "sam_prompt_encoder."),
    (r"^mask_decoder\.", "sam_mask_decoder."),
    (r"^memory_temporal_positional_encoding", "maskmem_tpos_enc"),
    (r"^no_memory_embedding", "no_mem_embed"),
    (r"^no_memory_positional_encoding", "no_mem_pos_enc"),
    (r"^no_object_pointer", "no_obj_ptr"),
    (r"^occlusion_spatial_embedding_parameter", "no_obj_embed_spatial"),
    (r"^object_pointer_proj", "obj_ptr_proj"),
    (r"^temporal_positional_encoding_projection_layer", "obj_ptr_tpos_proj"),
)


Load = Callable[[torch.nn.Module, dict[str, torch.Tensor]], tuple[torch.nn.Module, torch.nn.Module]]
"""Loads weights into the authors' network, and returns our image network and our video network with them."""


def randomise(state: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return weights that keep the signals' size from layer to layer; all objects are visible in all frames."""
    for name, value in state.items():
        noise = torch.randn(value.shape)
        if name.endswith("positional_embedding"):
            state[name] = state["shared_image_embedding.positional_embedding"]
        elif "norm" in name:
            state[name] = 0.1 * noise + name.endswith("weight")
        elif name.endswith("bias"):
            state[name] = 0.1 * noise
        elif value.ndim > 1 and not re.search("token|embed|encoding$|pointer$|parameter$", name):
            # Transposed convolutions keep their input channels first.
            state[name] = noise * (value[0].numel() if "upscale" not in name else len(value)) ** -0.5
        else:
            state[name] = 0.5 * noise
    state["shared_image_embedding.positional_embedding"] = state["prompt_encoder.shared_embedding.positional_embedding"]
    # Random features differ little from frame to frame.
    state["mask_decoder.pred_obj_score_head.proj_out.weight"] *= 30
    state[SCORE_BIAS] += 100
    return state


def official_names(state: dict[str, torch.Tensor], names: tuple = NAMES) -> dict[str, torch.Tensor]:
    tensors = {}
    for name, value in state.items():
        for pattern, replacement in names:
            name = re.sub(pattern, replacement, name)
        tensors[name] = value
    del tensors["shared_image_embedding.positional_embedding"]
    points = tensors.pop("sam_prompt_encoder.point_embed.weight")
    tensors |= {f"sam_prompt_encoder.point_embeddings.{i}.weight": row[None] for i, row in enumerate(points)}
    return tensors


def official_predictor(folder: Path, config: str, changes: Callable[[dict], None]) -> torch.nn.Module:
    """Return the authors' video predictor for smaller images, by their configuration file after `changes`."""
    for name in ("hydra", "hydra.core", "hydra.core.global_hydra", "iopath", "iopath.common", "iopath.common.file_io"):
        sys.modules.setdefault(name, types.ModuleType(name))
    sys.modules["hydra"].initialize_config_module = None
    sys.modules["hydra.core.global_hydra"].GlobalHydra = mock.MagicMock()
    sys.modules["iopath.common.file_io"].g_pathmgr = None
    torchvision_parts.stand_in()
    sys.path.insert(0, str(folder))
    model = yaml.safe_load((folder / "sam2" / "configs" / config).read_text(encoding="utf-8"))["model"]
    model["image_size"] = SIDE
    changes(model)
    # Settings of their function that builds the predictor, which fills holes on CUDA only.
    model |= {"_target_": "sam2.sam2_video_predictor.SAM2VideoPredictor", "binarize_mask_from_pts_for_mem_enc": True}
    stability = {"via_stability": True, "stability_delta": 0.05, "stability_thresh": 0.98}
    model["sam_mask_decoder_extra_args"] = {f"dynamic_multimask_{key}": value for key, value in stability.items()}
    return instantiate(model).eval()


def instantiate(content):
    """Return the objects of the classes that a configuration names by ``_target_``."""
    if not isinstance(content, dict):
        # YAML 1.1 parses 1e-6 as text.
        return float(content) if re.fullmatch(r"\d+e-\d+", str(content)) else content
    values = {key: instantiate(value) for key, value in content.items()}
    if "_target_" not in values:
        return values
    module, _, name = values.pop("_target_").rpartition(".")
    return getattr(importlib.import_module(module), name)(**values)


def moving_discs(num_frames: int) -> tuple[list[np.ndarray], np.ndarray]:
    """Return a video of two textured discs on a textured background, and their labels in the first frame."""
    rng = np.random.default_rng(0)
    textures = [cv2.GaussianBlur(rng.normal(size=(SIDE, SIDE, 3)), (0, 0), 3) for _ in range(3)]
    y, x = np.mgrid[:SIDE, :SIDE]
    frames, seeds = [], None
    for t in range(num_frames):
        labels = np.zeros((SIDE, SIDE), np.uint16)
        labels[np.hypot(y - 90 - t, x - 80 - 4 * t) < 40] = 1
        labels[np.hypot(y - 160, x - 190 + 5 * t) < 30] = 2
        image = np.select([labels[..., None] == label for label in range(3)], textures)
        frames.append((127 + 300 * image).clip(0, 255).astype(np.uint8))
        seeds = labels if seeds is None else seeds
    return frames, seeds


class Masks(NamedTuple):
    """Logits (object, y, x) as the network has them, quality (object,), and masks or labels at the image's size."""

    logits: torch.Tensor
    quality: torch.Tensor
    found: np.ndarray


def official_boxes(official: torch.nn.Module, pixels: torch.Tensor) -> Masks:
    """Return the masks of the boxes by the authors' image predictor."""
    _, features, _, sizes = official._prepare_backbone_features(official.forward_image(pixels))
    features[-1] = features[-1] + official.no_mem_embed
    maps = [feature.permute(1, 2, 0).view(1, -1, *size) for feature, size in zip(features, sizes, strict=True)]
    corners = torch.from_numpy(BOXES).view(-1, 2, 2), torch.tensor([[2, 3]]).expand(len(BOXES), -1)
    sparse, dense = official.sam_prompt_encoder(points=corners, boxes=None, masks=None)
    logits, quality, _, _ = official.sam_mask_decoder(
        image_embeddings=maps[-1],
        image_pe=official.sam_prompt_encoder.get_dense_pe(),
        sparse_prompt_embeddings=sparse,
        dense_prompt_embeddings=dense,
        multimask_output=False,
        repeat_image=True,
        high_res_features=maps[:-1],
    )
    enlarged = functional.interpolate(logits, size=(SIDE, SIDE), mode="bilinear")
    return Masks(logits[:, 0], quality[:, 0], (enlarged[:, 0] > 0).numpy())


def our_boxes(model: torch.nn.Module, image: np.ndarray) -> Masks:
    """Return the masks of the boxes by our kernel."""
    outputs = []
    with model.register_forward_hook(lambda _module, _inputs, output: outputs.append(output)):
        masks, quality = segment_boxes_sam2(model, image, BOXES, Sam2Params())
    return Masks(torch.cat([output.pred_masks[0, :, 0] for output in outputs]), torch.from_numpy(quality), masks)


def official_video(official: torch.nn.Module, pixels: torch.Tensor, seeds: np.ndarray) -> Masks:
    """Return the objects tracked by the authors' video predictor."""
    with mock.patch("sam2.sam2_video_predictor.load_video_frames", return_value=(pixels, SIDE, SIDE)):
        state = official.init_state("")
    labels = official_labels(official, state, seeds)
    past = [outputs["non_cond_frame_outputs"] for outputs in state["output_dict_per_obj"].values()]
    kinds = ("pred_masks", "object_score_logits")
    logits, scores = (
        torch.cat([outputs[t][kind] for t in range(1, len(pixels)) for outputs in past]) for kind in kinds
    )
    return Masks(logits[:, 0], scores[:, 0], labels[1:])


def official_labels(official: torch.nn.Module, state: dict, seeds: np.ndarray) -> np.ndarray:
    """Return the labels of all frames by the authors' video predictor; a pixel has its most probable object."""
    for label in (1, 2):
        official.add_new_mask(state, 0, label, seeds == label)
    labels = []
    with mock.patch("sam2.sam2_video_predictor.tqdm", lambda frames, **_: frames):
        for _, _, masks in official.propagate_in_video(state):
            surest, index = masks[:, 0].max(dim=0)
            labels.append(torch.where(surest > 0, index + 1, 0).numpy())
    return np.stack(labels)


def our_video(model: torch.nn.Module, frames: list[np.ndarray], seeds: np.ndarray) -> Masks:
    """Return the objects tracked by our kernel."""
    outputs = []
    with model.register_forward_hook(lambda _module, _inputs, output: outputs.append(output)):
        labels = track_masks_sam2(model, frames, seeds, Sam2Params())
    logits = torch.cat([output.pred_masks for output in outputs[1:]])[:, 0]
    return Masks(logits, torch.cat([output.object_score_logits for output in outputs[1:]])[:, 0], labels[1:])


def report(name: str, ours: Masks, theirs: Masks, nudged: Masks) -> bool:
    """Print the differences, and return whether they are small."""
    pairs = ((ours.logits, theirs.logits), (ours.quality, theirs.quality), (nudged.logits, theirs.logits))
    figures = [((a - b).abs().max() / b[b > NOT_SEEN].std()).item() for a, b in pairs]
    changed, moved = (np.mean(masks.found != theirs.found) for masks in (ours, nudged))
    seen = (theirs.logits > NOT_SEEN).flatten(1).any(dim=1).double().mean()
    print(f"{name:14}", *(f"{value:9.1e}" for value in figures), end=" ")
    print(f"{changed:8.1e} {moved:8.1e} {seen:6.0%}", flush=True)
    # Where random weights amplify roundings, the authors' own change by one is the measure.
    return max(figures[:2]) <= max(BAR, figures[2]) and changed <= max(BAR, moved)


@contextmanager
def double_precision() -> Iterator[None]:
    """Run both codes and their memories in float64 instead of float32 and bfloat16."""
    kinds = dict.fromkeys(("float", "float32", "bfloat16"), torch.float64)
    with (
        mock.patch.multiple(torch, **kinds),
        mock.patch.object(torch.Tensor, "float", lambda tensor: tensor.to(torch.float64)),
    ):
        default = torch.get_default_dtype()
        torch.set_default_dtype(torch.float64)
        try:
            yield
        finally:
            torch.set_default_dtype(default)


def compare(official: torch.nn.Module, state: dict[str, torch.Tensor], load: Load) -> bool:
    """Return whether both codes agree."""
    frames, seeds = moving_discs(NUM_FRAMES)
    pixels = torch.cat([frame_tensor(frame, (SIDE, SIDE), torch.device("cpu")) for frame in frames])
    nudged_pixels = pixels * (1 + torch.finfo(pixels.dtype).eps)
    image_model, _ = load(official, state)
    theirs, nudged = (official_boxes(official, images[:1]) for images in (pixels, nudged_pixels))
    agrees = report("boxes", our_boxes(image_model, frames[0]), theirs, nudged)
    for name in ("video, seen", "now and then"):
        _, model = load(official, state)
        theirs, nudged = (official_video(official, video, seeds) for video in (pixels, nudged_pixels))
        agrees &= report(name, our_video(model, frames, seeds), theirs, nudged)
        # Half of the scores are below 0 next.
        state[SCORE_BIAS] -= theirs.quality.median()
    state[SCORE_BIAS] += 100
    return compare_frames(*load(official, state), official) and agrees


def compare_frames(image_model: torch.nn.Module, video_model: torch.nn.Module, official: torch.nn.Module) -> bool:
    """Compare masks and labels if each code reads and resizes the frames itself; return whether they agree."""
    # In shorter videos the authors' maximum age of pointers differs.
    frames, seeds = moving_discs(16)
    frames = [cv2.resize(frame, WIDE) for frame in frames]
    seeds = cv2.resize(seeds, WIDE, interpolation=cv2.INTER_NEAREST)
    boxes = BOXES * np.float32([WIDE[0] / SIDE, WIDE[1] / SIDE] * 2)
    with mock.patch.object(torch.jit, "script", lambda module: module):
        predictor = importlib.import_module("sam2.sam2_image_predictor").SAM2ImagePredictor(official)
    predictor._bb_feat_sizes = [(4 * GRID,) * 2, (2 * GRID,) * 2, (GRID,) * 2]
    predictor.set_image(frames[0])
    wanted, wanted_quality, _ = predictor.predict(box=boxes, multimask_output=False)
    masks, quality = segment_boxes_sam2(image_model, frames[0], boxes, Sam2Params())
    num_pixels = int(np.count_nonzero(masks != (wanted[:, 0] > 0)))
    difference = float(np.abs(quality - wanted_quality[:, 0]).max())
    print(f"boxes, end to end: {num_pixels} pixels of masks differ, quality by {difference:.1e}", flush=True)
    with tempfile.TemporaryDirectory() as folder, mock.patch("sam2.utils.misc.tqdm", lambda items, **_: items):
        for index, frame in enumerate(frames):
            # They read files of this name; PNG is lossless.
            Image.fromarray(frame).save(Path(folder) / f"{index}.jpg", format="png")
        state = official.init_state(folder)
    labels = official_labels(official, state, seeds)
    changed = int(np.count_nonzero(track_masks_sam2(video_model, frames, seeds, Sam2Params())[1:] != labels[1:]))
    print(f"video, end to end: {changed} pixels of labels differ in {len(frames)} frames", flush=True)
    # Boxes are float32 in ours.
    return num_pixels <= 1e-4 * masks.size and changed == 0 and difference <= 1e-4


def run(description: str, clone: str, compare_with: Callable[[Path], bool]) -> int:
    """Run a comparison from the command line; `compare_with` takes the folder of the authors' code."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--official", type=Path, required=True, help=f"checkout of {clone}")
    folder = parser.parse_args().official
    torch.set_num_threads(1)
    warnings.simplefilter("ignore")
    print(f"{'':14} {'logits':>9} {'scores':>9} {'one ulp':>9} {'pixels':>8} {'one ulp':>8} {'seen':>6}")
    with torch.inference_mode(), double_precision():
        torch.manual_seed(0)
        return 0 if compare_with(folder) else 1
