"""Agreement of our RAFT with the authors' code, and with torchvision's if it is installed.

Run ``python benchmarks/agreement/raft.py --official DIR``, DIR being a checkout of princeton-vl/RAFT. Both load the
same random state dict in the official layout and get the same pairs. It prints the flow's largest differences, in px;
last those from frame to flow, as the authors' demo and our kernel have it.
"""

import argparse
import contextlib
import importlib
import sys
from unittest import mock

import cv2
import numpy as np
import torch

from moseg.schemas.parameters.raft import RaftParams
from moseg.tasks.flow.raft import estimate_raft_flow
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.raft import build_raft

BARS = {torch.float64: 1e-4, torch.float32: 1e-3}
ITERATIONS = 12
SIZES = ((128, 192), (136, 256))
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
                    magnitude, held, on_demand, floor = compare(*make(size == "small"), dtype)
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


def compare(network: torch.nn.Module, run, dtype: torch.dtype) -> tuple[float, float, float, float]:
    """Return the largest flow and differences over all pairs: ours to theirs, held and on demand; theirs to theirs.

    The last shows the precision: their own change if the images change in the last digit.
    """
    tensors = random_state(network.state_dict())
    network.load_state_dict(tensors)
    network.to(dtype).eval()
    ours = build_raft(Checkpoint("random", tensors)).to(dtype)
    figures = np.zeros(4)
    for seed, size in enumerate(SIZES):
        pair = [image.to(dtype) for image in image_pair(size, seed)]
        theirs = run(pair)
        held, on_demand = (ours(*(to_unit(image) for image in pair), ITERATIONS, way) for way in (False, True))
        nudged = run([image * (1 + torch.finfo(dtype).eps) for image in pair])
        found = [theirs, held - theirs, on_demand - theirs, nudged - theirs]
        figures = np.maximum(figures, [float(values.abs().max()) for values in found])
    return tuple(figures)


def compare_frames(is_small: bool) -> tuple[float, float]:
    """Return the largest flow and its largest difference, on frames of a size that has to be padded."""
    network, _ = princeton(is_small)
    tensors = random_state(network.state_dict())
    network.load_state_dict(tensors)
    network.eval()
    pair = [image[0].permute(1, 2, 0).numpy().astype(np.uint8) for image in image_pair(ODD_SIZE, 0)]
    seen = [torch.from_numpy(image).permute(2, 0, 1).float()[None] for image in pair]
    padder = importlib.import_module("utils.utils").InputPadder(seen[0].shape)
    flow = padder.unpad(network(*padder.pad(*seen), iters=20, test_mode=True)[1])[0].permute(1, 2, 0).numpy()
    ours = build_raft(Checkpoint("random", tensors))
    found = estimate_raft_flow(ours, *(image[None] for image in pair), RaftParams())[0]
    return float(np.abs(flow).max()), float(np.abs(found - flow).max())


def random_state(state: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return random tensors of the same names and shapes, with gains that keep the flow in the image and nonzero."""
    generator = torch.Generator().manual_seed(0)
    made: dict[int, torch.Tensor] = {}
    for key, value in state.items():
        # Two names of one tensor (princeton's norm3 and downsample) keep one value.
        if value.data_ptr() not in made:
            made[value.data_ptr()] = random_tensor(key, value, generator)
    return {key: made[value.data_ptr()] for key, value in state.items()}


def random_tensor(key: str, value: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
    if not value.is_floating_point():
        return value.clone()
    noise = torch.randn(value.shape, generator=generator, dtype=torch.float32)
    if value.ndim == 4:
        gain = 0.05 if "flow_head.conv2" in key else 1.0
        return gain * noise * (2 / value[0].numel()) ** 0.5
    # Variances and scales of normalisations about one, biases and means about zero.
    return 1 + 0.2 * noise.clamp(-2, 2) if key.endswith(("running_var", "norm1.weight", ".1.weight")) else 0.1 * noise


def image_pair(size: tuple[int, int], seed: int) -> list[torch.Tensor]:
    """Return a smooth texture, and the same slightly shifted and changed: (1, 3, y, x) in [0, 255]."""
    rng = np.random.default_rng(seed)
    noise = cv2.GaussianBlur(rng.normal(size=(*size, 3)), (0, 0), 2.0)
    first = 127 + 40 * noise / noise.std()
    second = np.roll(first, (3, -5), axis=(0, 1)) + rng.normal(scale=2.0, size=first.shape)
    return [torch.from_numpy(np.clip(image, 0, 255).transpose(2, 0, 1)[None].copy()) for image in (first, second)]


def to_unit(image: torch.Tensor) -> torch.Tensor:
    return 2 * (image / 255) - 1


@contextlib.contextmanager
def default_dtype(dtype: torch.dtype):
    """Run official code in a precision that it does not provide: it uses float32 by default and by `float()`."""
    before = torch.get_default_dtype()
    torch.set_default_dtype(dtype)
    try:
        with mock.patch.object(torch.Tensor, "float", lambda tensor: tensor.to(dtype)):
            yield
    finally:
        torch.set_default_dtype(before)


if __name__ == "__main__":
    main()
