"""Agreement of our SEA-RAFT with the authors' code.

Run ``python benchmarks/agreement/sea_raft.py --official DIR [--out FILE]``, DIR being a checkout of
princeton-vl/SEA-RAFT. Both load the same random state dict in the official layout and get the same pairs. It prints the
flow's largest differences, in px, and writes them to FILE; last those from frame to flow, as the authors' evaluation
and our kernel have it: at the frames' size, which has to be padded, and at half of it (their ``scale`` of -1).
"""

import argparse
import importlib
import json
import sys
import types
from pathlib import Path

import numpy as np
import torch
from flow_pairs import compare, default_dtype, image_pair, random_state

from moseg.schemas.parameters import SeaRaftParams
from moseg.tasks.flow.raft import estimate_raft_flow
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.sea_raft import build_sea_raft

BARS = {torch.float64: 1e-4, torch.float32: 1e-3}
ITERATIONS = 4
GAINS = {"flow_head.2": 0.02, ".conv2.": 0.1}
# Their size, and their longer side for the network; the authors' scale is the logarithm of the quotient.
FRAMES = (((133, 197), 197), ((266, 394), 197))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of princeton-vl/SEA-RAFT")
    parser.add_argument("--out", type=Path, help="JSON file of the figures")
    options = parser.parse_args()
    sys.path.insert(0, str(options.official / "core"))
    stand_in_for_pretrained_weights()
    torch.set_num_threads(1)
    rows = [compare_networks(options.official, size, dtype) for size in "MS" for dtype in BARS]
    rows += [compare_frames(options.official, size, *frames) for size in "MS" for frames in FRAMES]
    for row in rows:
        print(
            "  ".join(f"{name} {value:.2g}" if isinstance(value, float) else str(value) for name, value in row.items())
        )
    if options.out is not None:
        options.out.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    sys.exit(0 if all(row["agrees"] for row in rows) else 1)


def stand_in_for_pretrained_weights() -> None:
    """Register the functions of torchvision that give ImageNet's weights, which training begins with: none."""
    models = types.ModuleType("torchvision.models")
    for depth in (18, 34):
        setattr(models, f"ResNet{depth}_Weights", argparse.Namespace(IMAGENET1K_V1=None))
        setattr(models, f"resnet{depth}", lambda weights: torch.nn.Module())
    sys.modules["torchvision"] = types.ModuleType("torchvision")
    sys.modules["torchvision.models"] = models


def official_network(folder: Path, size: str) -> torch.nn.Module:
    """Return the authors' module of their configuration for Spring."""
    values = json.loads((folder / "config" / "eval" / f"spring-{size}.json").read_text(encoding="utf-8"))
    return importlib.import_module("raft").RAFT(argparse.Namespace(**values))


def compare_networks(folder: Path, size: str, dtype: torch.dtype) -> dict:
    """Return the figures of the networks alone."""
    with torch.inference_mode(), default_dtype(dtype):
        network = official_network(folder, size)

        def run(pair: list[torch.Tensor]) -> torch.Tensor:
            return network(*pair, iters=ITERATIONS, test_mode=True)["final"]

        magnitude, held, on_demand, floor = compare(network, run, build_sea_raft, ITERATIONS, GAINS, dtype)
    return {
        "network": f"SEA-RAFT {size}",
        "compared": str(dtype).removeprefix("torch."),
        "largest flow": magnitude,
        "volume": held,
        "on demand": on_demand,
        "one ulp": floor,
        "agrees": bool(max(held, on_demand) <= BARS[dtype] and magnitude > 1),
    }


def compare_frames(folder: Path, size: str, shape: tuple[int, int], max_side: int) -> dict:
    """Return the figures from RGB frames to flow at their size."""
    network = official_network(folder, size)
    tensors = random_state(network.state_dict(), GAINS)
    network.load_state_dict(tensors)
    network.eval()
    pair = [image[0].permute(1, 2, 0).numpy().astype(np.uint8) for image in image_pair(shape, 0)]
    with torch.inference_mode():
        theirs = official_flow(network, pair, max_side / max(shape))
    params = SeaRaftParams(max_side=max_side, iterations=ITERATIONS)
    ours = estimate_raft_flow(build_sea_raft(Checkpoint("random", tensors)), *(image[None] for image in pair), params)
    magnitude, difference = float(np.abs(theirs).max()), float(np.abs(ours[0] - theirs).max())
    return {
        "network": f"SEA-RAFT {size}",
        "compared": f"frames of {shape[1]}x{shape[0]}, longer side {max_side} px for the network",
        "largest flow": magnitude,
        "end to end": difference,
        "agrees": difference <= BARS[torch.float32] and magnitude > 1,
    }


def official_flow(network: torch.nn.Module, pair: list[np.ndarray], scale: float) -> np.ndarray:
    """Return flow (y, x, 2) by the steps of the authors' ``calc_flow``: resize, estimate with padding, resize."""
    resize = torch.nn.functional.interpolate
    seen = [torch.from_numpy(image).permute(2, 0, 1).float()[None] for image in pair]
    smaller = [resize(image, scale_factor=scale, mode="bilinear", align_corners=False) for image in seen]
    flow = network(*smaller, iters=ITERATIONS, test_mode=True)["flow"][-1]
    flow = resize(flow, scale_factor=1 / scale, mode="bilinear", align_corners=False) / scale
    return flow[0].permute(1, 2, 0).numpy()


if __name__ == "__main__":
    main()
