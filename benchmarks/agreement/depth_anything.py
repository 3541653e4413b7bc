"""Agreement of Depth Anything V2 by transformers, as our kernel runs it, with the authors' code.

Run ``python benchmarks/agreement/depth_anything.py --official DIR``, DIR being a checkout of
DepthAnything/Depth-Anything-V2; torchvision is not needed. Both load the same random weights of the small network and
get the same frames, of the size of its position encodings and of other sizes, for which these are resampled. It prints
the largest difference of inverse depth as a share of its spread, and that of the authors' own result if the frame
changes in the last digit. Last come resized frames, from the frame to the map at its size.
"""

import argparse
import importlib
import re
import sys
import warnings
from pathlib import Path

import cv2
import numpy as np
import torch
import torchvision_parts
from dinov2_names import official_backbone, random_state
from transformers import DepthAnythingConfig, DepthAnythingForDepthEstimation, Dinov2Config

from moseg.schemas.parameters.depth_anything import DepthAnythingParams
from moseg.tasks.depth import estimate_inverse_depth
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth import build_depth_anything
from moseg.tasks.networks.frame_tensor import frame_tensor

BAR = 1e-4
SIZES = ((518, 518), (140, 238), (266, 462))
RESIZED, SHORT_SIDE = ((240, 427), (100, 133), (333, 250)), 140
# Published names of the head's tensors to the authors', applied one after the other.
NAMES = (
    (r"^neck\.reassemble_stage\.layers\.(\d)\.projection", r"projects.\1"),
    (r"^neck\.reassemble_stage\.layers\.(\d)\.resize", r"resize_layers.\1"),
    (r"^neck\.convs\.(\d)", lambda found: f"scratch.layer{int(found[1]) + 1}_rn"),
    (r"^neck\.fusion_stage\.layers\.(\d)", lambda found: f"scratch.refinenet{4 - int(found[1])}"),
    (r"residual_layer(\d)\.convolution(\d)", r"resConfUnit\1.conv\2"),
    (r"(refinenet\d)\.projection", r"\1.out_conv"),
    (r"^head\.conv1", "scratch.output_conv1"),
    (r"^head\.conv2", "scratch.output_conv2.0"),
    (r"^head\.conv3", "scratch.output_conv2.2"),
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of DepthAnything/Depth-Anything-V2")
    folder = parser.parse_args().official
    torch.set_num_threads(1)
    warnings.simplefilter("ignore")
    torch.manual_seed(0)
    config = DepthAnythingConfig(
        backbone_config=Dinov2Config(
            hidden_size=384,
            num_attention_heads=6,
            image_size=518,
            patch_size=14,
            out_indices=[3, 6, 9, 12],
            reshape_hidden_states=False,
        ),
        reassemble_hidden_size=384,
        neck_hidden_sizes=[48, 96, 192, 384],
        fusion_hidden_size=64,
    )
    state = random_state(DepthAnythingForDepthEstimation(config))
    # Far from 0, where inverse depth is clipped.
    state["head.conv3.bias"] += 3
    ours = build_depth_anything(Checkpoint("random", state, {"config.json": config.to_json_string()}))
    official = build_official(folder)
    tensors = {f"pretrained.{name}": value for name, value in official_backbone(state).items()}
    official.load_state_dict(tensors | {f"depth_head.{name}": value for name, value in official_head(state).items()})
    agrees = True
    print(f"{'frame':10} {'spread':>7} {'difference':>11} {'one ulp':>9}")
    for height, width in SIZES:
        frame = random_frame(height, width)
        got = estimate_inverse_depth(ours, frame[None], DepthAnythingParams(short_side=min(height, width)))
        with torch.inference_mode():
            pixels = frame_tensor(frame, (height, width), torch.device("cpu"))
            nudged_pixels = pixels * (1 + torch.finfo(pixels.dtype).eps)
            wanted, nudged = (official(image).numpy() for image in (pixels, nudged_pixels))
        figures = [float(np.abs(found - wanted).max() / wanted.std()) for found in (got, nudged)]
        print(f"{width}x{height:<6} {wanted.std():7.2f} {figures[0]:11.1e} {figures[1]:9.1e}", flush=True)
        agrees &= figures[0] <= BAR
    for height, width in RESIZED:
        frame = random_frame(height, width)
        got = estimate_inverse_depth(ours, frame[None], DepthAnythingParams(short_side=SHORT_SIDE))[0]
        wanted = official.infer_image(frame[..., ::-1], SHORT_SIDE)
        figure = float(np.abs(got - wanted).max() / wanted.std())
        print(f"{width}x{height:<6} {wanted.std():7.2f} {figure:11.1e} end to end", flush=True)
        agrees &= figure <= BAR
    return 0 if agrees else 1


def random_frame(height: int, width: int) -> np.ndarray:
    frame = cv2.GaussianBlur(np.random.default_rng(0).normal(size=(height, width, 3)), (0, 0), 5)
    return (127 + 1000 * frame).clip(0, 255).astype(np.uint8)


def official_head(state: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    tensors = {}
    for name, value in state.items():
        for pattern, replacement in NAMES:
            name = re.sub(pattern, replacement, name)
        tensors[name] = value
    return {name: value for name, value in tensors.items() if not name.startswith("backbone.")}


def build_official(folder: Path) -> torch.nn.Module:
    """Return the authors' small network."""
    torchvision_parts.stand_in()
    sys.path.insert(0, str(folder))
    network = importlib.import_module("depth_anything_v2.dpt").DepthAnythingV2
    return network("vits", features=64, out_channels=[48, 96, 192, 384]).eval()


if __name__ == "__main__":
    sys.exit(main())
