"""Agreement of our RAFT with the authors' code, and with torchvision's if it is installed.

Run ``python benchmarks/agreement/raft.py --official DIR``, DIR being a checkout of princeton-vl/RAFT. Both load the
same random state dict in the official layout and get the same pairs. It prints the flow's largest differences, in px;
last those from frame to flow, as the authors' demo and our kernel have it.
"""

import argparse
import contextlib
import importlib
import sys

import numpy as np
import torch
from flow_pairs import compare, default_dtype, image_pair, random_state, to_unit

from moseg.schemas.parameters.raft import RaftParams
from moseg.tasks.flow.raft import estimate_raft_flow
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.raft import build_raft

BARS = {torch.float64: 1e-4, torch.float32: 1e-3}
ITERATIONS = 12
GAINS = {"flow_head.conv2": 0.05}
ODD_SIZE = (133, 197)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", required=True, help="checkout of princeton-vl/RAFT")
    sys.path.insert(0, parser.parse_args().official + "/core")
    torch.set_num_threads(1)
    makers = {"princeton": princeton}
    with contextlib.suppress(ImportError):
        optical_flow = importlib.import_module("torchvision.models.optical_flow")
        makers["torchvision"] = lambda is_small: torchvision(optical_flow, is_small)
    print(f"{'layout':12} {'size':6} {'dtype':8} {'largest flow':>13} {'volume':>9} {'on demand':>10} {'one ulp':>9}")
    agrees = True
    for layout, make in makers.items():
        for size in ("large", "small"):
            for dtype, bar in BARS.items():
                with torch.inference_mode(), default_dtype(dtype):
                    magnitude, held, on_demand, floor = compare(
                        *make(size == "small"), build_raft, ITERATIONS, GAINS, dtype
                    )
                agrees &= max(held, on_demand) <= bar and magnitude > 1
                name = str(dtype).removeprefix("torch.")
                print(f"{layout:12} {size:6} {name:8} {magnitude:10.2f} px {held:9.1e} {on_demand:10.1e} {floor:9.1e}")
    for size in ("large", "small"):
        with torch.inference_mode():
            magnitude, difference = compare_frames(size == "small")
        agrees &= difference <= BARS[torch.float32] and magnitude > 1
        print(f"{'demo':12} {size:6} {'float32':8} {magnitude:10.2f} px {difference:9.1e} end to end")
    sys.exit(0 if agrees else 1)


def princeton(is_small: bool):
    """Return the authors' module, and a function that runs it on images in [0, 255]."""
    arguments = argparse.Namespace(small=is_small, mixed_precision=False)
    network = importlib.import_module("raft").RAFT(arguments)
    return network, lambda pair: network(*pair, iters=ITERATIONS, test_mode=True)[1]


def torchvision(optical_flow, is_small: bool):
    """Return the same of torchvision, whose caller scales the images."""
    network = (optical_flow.raft_small if is_small else optical_flow.raft_large)(weights=None)
    return network, lambda pair: network(*(to_unit(image) for image in pair), num_flow_updates=ITERATIONS)[-1]


def compare_frames(is_small: bool) -> tuple[float, float]:
    """Return the largest flow and its largest difference, on frames of a size that has to be padded."""
    network, _ = princeton(is_small)
    tensors = random_state(network.state_dict(), GAINS)
    network.load_state_dict(tensors)
    network.eval()
    pair = [image[0].permute(1, 2, 0).numpy().astype(np.uint8) for image in image_pair(ODD_SIZE, 0)]
    seen = [torch.from_numpy(image).permute(2, 0, 1).float()[None] for image in pair]
    padder = importlib.import_module("utils.utils").InputPadder(seen[0].shape)
    flow = padder.unpad(network(*padder.pad(*seen), iters=20, test_mode=True)[1])[0].permute(1, 2, 0).numpy()
    ours = build_raft(Checkpoint("random", tensors))
    found = estimate_raft_flow(ours, *(image[None] for image in pair), RaftParams())[0]
    return float(np.abs(flow).max()), float(np.abs(found - flow).max())


if __name__ == "__main__":
    main()
