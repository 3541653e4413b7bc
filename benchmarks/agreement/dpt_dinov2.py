"""Agreement of DINOv2 with a DPT head by transformers, as our kernel runs it, with the authors' code.

Run ``python benchmarks/agreement/dpt_dinov2.py --official DIR``, DIR being a checkout of facebookresearch/dinov2. Both
load the same random weights of the small network and get the same frames, of the size of its position encodings and of
other sizes, for which these are resampled and the frame is padded. It prints the largest difference of depth as a share
of its spread, and that of the authors' own result if the frame changes in the last digit.

The authors add their minimum depth of 1 mm to the network's output, transformers does not; here it is subtracted. Last
comes the stored inverse depth, from the frame on. Ours differs on purpose in two places: the authors' code stretches a
prediction with its border over the frame, and interpolates depth instead of inverse depth.
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
from dinov2_names import official_backbone, random_state
from transformers import Dinov2Config, DPTConfig, DPTForDepthEstimation

from moseg.schemas.parameters.dpt_dinov2 import DptDinov2Params
from moseg.tasks.depth import estimate_inverse_depth
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth import build_dpt_dinov2
from moseg.tasks.networks.frame_tensor import frame_tensor

BAR = 1e-4
LEAST_DEPTH, LARGEST_DEPTH = 0.001, 10.0
NEAREST = DptDinov2Params().nearest
MEAN, STD = (123.675, 116.28, 103.53), (58.395, 57.12, 57.375)
SIZES = ((518, 518), (140, 238), (100, 171), (266, 462))
# Published names of the head's tensors to the authors', applied one after the other.
NAMES = (
    (r"^neck\.reassemble_stage\.layers\.(\d)\.projection", r"reassemble_blocks.projects.\1.conv"),
    (r"^neck\.reassemble_stage\.layers\.(\d)\.resize", r"reassemble_blocks.resize_layers.\1"),
    (r"^neck\.reassemble_stage\.readout", "reassemble_blocks.readout"),
    (r"^neck\.convs\.(\d)", r"convs.\1.conv"),
    (r"^neck\.fusion_stage\.layers\.", "fusion_blocks."),
    (r"residual_layer(\d)\.convolution(\d)", r"res_conv_unit\1.conv\2.conv"),
    (r"(fusion_blocks\.\d)\.projection", r"\1.project.conv"),
    (r"^head\.projection", "project.conv"),
    (r"^head\.head", "conv_depth.head"),
)
# The first block has nothing to fuse; transformers keeps tensors for it.
UNUSED = "fusion_blocks.0.res_conv_unit1"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of facebookresearch/dinov2")
    sys.path.insert(0, str(parser.parse_args().official))
    torch.set_num_threads(1)
    warnings.simplefilter("ignore")
    torch.manual_seed(0)
    config = DPTConfig(
        backbone_config=Dinov2Config(
            hidden_size=384,
            num_attention_heads=6,
            image_size=518,
            patch_size=14,
            out_indices=[3, 6, 9, 12],
            reshape_hidden_states=False,
            apply_layernorm=False,
        ),
        neck_hidden_sizes=[48, 96, 192, 384],
        fusion_hidden_size=256,
        use_bias_in_fusion_residual=False,
        add_projection=True,
    )
    state = random_state(DPTForDepthEstimation(config))
    # Far from 0, where depth is clipped.
    state["head.head.4.bias"] += 7
    # The range of the authors' default, that of NYU; random depths exceed it.
    depths = {"min_depth": LEAST_DEPTH, "max_depth": LARGEST_DEPTH}
    ours = build_dpt_dinov2(Checkpoint("random", state, {"config.json": config.to_json_string()}, depths))
    official = importlib.import_module("dinov2.hub.depthers").dinov2_vits14_dd(pretrained=False).eval()
    tensors = {f"backbone.{name}": value for name, value in official_backbone(state).items()}
    official.load_state_dict(tensors | {f"decode_head.{name}": value for name, value in official_head(state).items()})
    agrees = True
    print(f"{'frame':10} {'spread':>7} {'difference':>11} {'one ulp':>9}")
    for height, width in SIZES:
        frame = random_frame(height, width)
        outputs = []
        with ours.model.register_forward_hook(lambda _module, _inputs, output, kept=outputs: kept.append(output)):
            estimate_inverse_depth(ours, frame[None], DptDinov2Params())
        got = outputs[0].predicted_depth
        with torch.inference_mode():
            pixels = frame_tensor(frame, (height, width), torch.device("cpu"))
            nudged_pixels = pixels * (1 + torch.finfo(pixels.dtype).eps)
            wanted, nudged = (
                official.decode_head(official.extract_feat(image), None)[:, 0] - LEAST_DEPTH
                for image in (pixels, nudged_pixels)
            )
        figures = [((found - wanted).abs().max() / wanted.std()).item() for found in (got, nudged)]
        print(f"{width}x{height:<6} {wanted.std():7.2f} {figures[0]:11.1e} {figures[1]:9.1e}", flush=True)
        agrees &= figures[0] <= BAR
    for height, width in SIZES:
        frame = random_frame(height, width)
        got = estimate_inverse_depth(ours, frame[None], DptDinov2Params())[0]
        with torch.inference_mode():
            # Their notebook's transform.
            pixels = torch.from_numpy(frame).permute(2, 0, 1)[None] / 255 * 255.0
            pixels = (pixels - torch.tensor(MEAN).view(3, 1, 1)) / torch.tensor(STD).view(3, 1, 1)
            wanted = 1 / official.whole_inference(pixels, None, True)[0, 0].clamp(min=NEAREST).numpy()
        differences = np.abs(got - wanted) / wanted.std()
        figures = f"{differences.max():11.1e} at most, {np.median(differences):.1e} in the median"
        print(
            f"{width}x{height:<6} {wanted.std():7.2f} {figures} end to end; "
            f"{np.mean(wanted <= 1.001 / LARGEST_DEPTH):.0%} at {LARGEST_DEPTH:.0f} m",
            flush=True,
        )
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
    return {name: value for name, value in tensors.items() if not name.startswith(("backbone.", UNUSED))}


if __name__ == "__main__":
    sys.exit(main())
