"""Agreement of SAM 2.1 by transformers, as our kernels run it, with the authors' code.

Run ``python benchmarks/agreement/sam2.py --official DIR``, DIR being a checkout of facebookresearch/sam2; neither
torchvision nor hydra is needed. Both load the same random weights of the tiny network, at 256 px instead of 1024, and
get the same boxes on an image and the same masks in a video's first frame. Differences are printed as shares of the
spread of what is compared, beside the authors' own if the frames change in the last digit, then shares of the pixels
whose label differs, and how often the objects are visible.

From the frame on, last, the authors' predictors resize frames of another size themselves.

It runs in float64, because in float32 random weights amplify rounding so much that 20 frames cannot be compared.
"""

import sys
from pathlib import Path

import sam2_family
import torch
from sam2_family import GRID, SIDE
from transformers import Sam2Model, Sam2VideoConfig, Sam2VideoModel

from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.sam2 import build_sam2_image, build_sam2_video


def our_config() -> Sam2VideoConfig:
    """Return the configuration of the published tiny network, transformers' default, for smaller images."""
    return Sam2VideoConfig(
        vision_config={
            "model_type": "sam2_vision_model",
            "backbone_config": {"model_type": "sam2_hiera_det_model", "image_size": [SIDE, SIDE]},
            "backbone_feature_sizes": [[4 * GRID] * 2, [2 * GRID] * 2, [GRID] * 2],
        },
        prompt_encoder_config={"image_size": SIDE},
        image_size=SIDE,
        memory_attention_rope_feat_sizes=[GRID, GRID],
    )


def compare(folder: Path) -> bool:
    """Return whether our networks agree with the authors' code in a folder."""
    official = sam2_family.official_predictor(folder, "sam2.1/sam2.1_hiera_t.yaml", _reduce)
    state = sam2_family.randomise(Sam2VideoModel(our_config()).state_dict())
    return sam2_family.compare(official, state, load)


def _reduce(model: dict) -> None:
    for kind in ("self_attention", "cross_attention"):
        model["memory_attention"]["layer"][kind]["feat_sizes"] = [GRID, GRID]


def load(official: torch.nn.Module, state: dict[str, torch.Tensor]) -> tuple[Sam2Model, Sam2VideoModel]:
    """Return our networks with these weights, which the official one loads as well."""
    official.load_state_dict(sam2_family.official_names(state))
    checkpoint = Checkpoint("random", state, {"config.json": our_config().to_json_string()})
    return build_sam2_image(checkpoint), build_sam2_video(checkpoint)


if __name__ == "__main__":
    sys.exit(sam2_family.run(__doc__.splitlines()[0], "facebookresearch/sam2", compare))
