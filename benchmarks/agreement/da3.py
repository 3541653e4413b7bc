"""Agreement of our Depth Anything 3 with the authors' code.

Run ``python benchmarks/agreement/da3.py --official DIR [--out FILE]``, DIR being a checkout of
ByteDance-Seed/Depth-Anything-3; einops, addict, omegaconf and torchvision are not needed. Both load the same random
state dict of the authors' complete network and get the same frames. It prints the largest differences as shares of the
spread, and writes them to FILE: of the logarithm of depth at sizes of whole patches; that of the authors' own result if
the frame changes in the last digit; and, from the frame to the map that is stored, of inverse depth at the frame's
size, with the authors' preprocessing, and their depth inverted and resized as ours. The script must not be named like
the authors' package, which it imports.
"""

import argparse
import importlib
import json
import sys
import types
from pathlib import Path

import cv2
import numpy as np
import torch
import torchvision_parts

from moseg.schemas.parameters import DepthAnything3Params
from moseg.tasks.depth import estimate_inverse_depth
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth_anything_3 import build_depth_anything_3

BARS = {torch.float64: 1e-4, torch.float32: 1e-3}
NETWORKS = {"small": ("vits", 384, 64), "base": ("vitb", 768, 128)}
SIZES = ((518, 518), (140, 238), (280, 504))
# Frames, and the longer side for the network: reduced, enlarged, of whole patches, upright, and of odd ratios.
FRAMES = (((480, 854), 504), ((100, 133), 252), ((140, 252), 252), ((427, 240), 252), ((333, 250), 238))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", type=Path, required=True, help="checkout of ByteDance-Seed/Depth-Anything-3")
    parser.add_argument("--out", type=Path, help="JSON file of the figures")
    options = parser.parse_args()
    torch.set_num_threads(1)
    sys.path.insert(0, str(options.official / "src"))
    stand_in()
    rows = []
    for name in NETWORKS:
        official = official_network(name)
        tensors = random_state(official)
        official.load_state_dict(tensors)
        # The decoder of cameras does not run in float64.
        official.cam_dec = None
        document = json.dumps({"model_name": f"da3-{name}"})
        named = {f"model.{key}": value for key, value in tensors.items()}
        ours = build_depth_anything_3(Checkpoint("random", named, {"config.json": document}))
        rows += [compare_networks(name, official, ours, size) for size in SIZES]
        rows += [compare_frames(name, official, ours, *frames) for frames in FRAMES]
    for row in rows:
        print("  ".join(f"{key} {value:.2g}" if isinstance(value, float) else str(value) for key, value in row.items()))
    if options.out is not None:
        options.out.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    sys.exit(0 if all(row["agrees"] for row in rows) else 1)


def stand_in() -> None:
    """Register the few functions of other packages that the authors' network and preprocessing call."""
    torchvision_parts.stand_in()
    parts = {
        "einops": {"rearrange": rearrange, "einsum": None, "repeat": None},
        "addict": {"Dict": AttributeDict},
        "omegaconf": {
            "DictConfig": None,
            "ListConfig": None,
            "OmegaConf": types.SimpleNamespace(register_new_resolver=print),
        },
        "imageio": {},
    }
    for name, values in parts.items():
        module = types.ModuleType(name)
        vars(module).update(values)
        sys.modules[name] = module


class AttributeDict(dict):
    """A dictionary whose values are attributes too."""

    __getattr__ = dict.__getitem__
    __setattr__ = dict.__setitem__
    __delattr__ = dict.__delitem__


def rearrange(tensor: torch.Tensor, pattern: str, **sizes: int) -> torch.Tensor:
    """Return a tensor with its axes split and joined by a pattern like ``(b s) n c -> b s n c``; none is permuted."""
    left, right = (side.strip() for side in pattern.split("->"))
    axes = iter(tensor.shape)
    lengths = dict(sizes)
    for group in groups(left):
        length = next(axes)
        unknown = [axis for axis in group if axis not in lengths]
        known = int(np.prod([lengths[axis] for axis in group if axis in lengths]))
        lengths |= dict.fromkeys(unknown, length // known)
    return tensor.reshape([int(np.prod([lengths[axis] for axis in group])) for group in groups(right)])


def groups(side: str) -> list[list[str]]:
    """Return the names of a pattern's side, those in parentheses together."""
    found: list[list[str]] = []
    is_open = False
    for word in side.replace("(", " ( ").replace(")", " ) ").split():
        if word in "()":
            is_open = word == "("
            if is_open:
                found.append([])
        elif is_open:
            found[-1].append(word)
        else:
            found.append([word])
    return found


def official_network(name: str) -> torch.nn.Module:
    """Return the authors' network with the values of its file in their folder ``configs``."""
    encoder, width, features = NETWORKS[name]
    module = importlib.import_module
    backbone = module("depth_anything_3.model.dinov2.dinov2").DinoV2(
        name=encoder, out_layers=[5, 7, 9, 11], alt_start=4, qknorm_start=4, rope_start=4, cat_token=True
    )
    channels = [width // 8, width // 4, width // 2, width]
    head = module("depth_anything_3.model.dualdpt").DualDPT(
        dim_in=2 * width, output_dim=2, features=features, out_channels=channels
    )
    cameras = (
        module("depth_anything_3.model.cam_dec").CameraDec(dim_in=2 * width),
        module("depth_anything_3.model.cam_enc").CameraEnc(dim_out=width),
    )
    return module("depth_anything_3.model.da3").DepthAnything3Net(backbone, head, *cameras).eval()


def random_state(network: torch.nn.Module) -> dict[str, torch.Tensor]:
    """Return weights that keep signal sizes from layer to layer, and smooth positions, like trained ones."""
    generator = torch.Generator().manual_seed(0)
    state = network.state_dict()
    for name, value in state.items():
        noise = torch.randn(value.shape, generator=generator)
        if name.endswith("pos_embed"):
            cells = torch.randn(1, value.shape[2], 8, 8, generator=generator)
            side = round((value.shape[1] - 1) ** 0.5)
            smooth = torch.nn.functional.interpolate(cells, (side, side), mode="bicubic").flatten(2).transpose(1, 2)
            state[name] = torch.cat([noise[:, :1], smooth], dim=1)
        elif name.endswith(("_token", "gamma")):
            state[name] = noise * (0.3 if name.endswith("gamma") else 1.0)
        elif value.ndim > 1:
            fan_in = len(value) if "resize_layers.0" in name or "resize_layers.1" in name else value[0].numel()
            state[name] = noise * fan_in**-0.5
        else:
            state[name] = 0.1 * noise + ("norm" in name and name.endswith("weight"))
    return state


def compare_networks(name: str, official: torch.nn.Module, ours: torch.nn.Module, size: tuple[int, int]) -> dict:
    """Return the figures of the networks alone, in both precisions."""
    pixels = torch.from_numpy(random_frame(*size)).permute(2, 0, 1)[None].double() / 127.5 - 1
    figures: dict = {"network": name, "compared": f"logarithm of depth, {size[1]}x{size[0]}"}
    agrees = True
    for dtype, bar in BARS.items():
        theirs, own, image = official.to(dtype), ours.to(dtype), pixels.to(dtype)
        with torch.inference_mode():
            frames = (image, image * (1 + torch.finfo(dtype).eps))
            wanted, nudged = (theirs(each[:, None]).depth[:, 0].log() for each in frames)
            got = own(image)
        kind = str(dtype).removeprefix("torch.")
        spread = float(wanted.std())
        figures |= {f"spread in {kind}": spread, kind: float((got - wanted).abs().max()) / spread}
        figures[f"one ulp of {kind}"] = float((nudged - wanted).abs().max()) / spread
        agrees &= figures[kind] <= bar
    return figures | {"agrees": agrees}


def compare_frames(
    name: str, official: torch.nn.Module, ours: torch.nn.Module, size: tuple[int, int], side: int
) -> dict:
    """Return the figures from RGB frames to what is stored."""
    frame = random_frame(*size)
    processor = importlib.import_module("depth_anything_3.utils.io.input_processor").InputProcessor()
    pixels, _, _ = processor([frame], process_res=side, process_res_method="upper_bound_resize", sequential=True)
    with torch.inference_mode():
        depth = official(pixels[None]).depth
    wanted = torch.nn.functional.interpolate(1 / depth, size=size, mode="bilinear")[0, 0].numpy()
    got = estimate_inverse_depth(ours, frame[None], DepthAnything3Params(side=side))[0]
    spread = float(wanted.std())
    difference = float(np.abs(got - wanted).max()) / spread
    return {
        "network": name,
        "compared": f"inverse depth, frame of {size[1]}x{size[0]}, {pixels.shape[3]}x{pixels.shape[2]} for the network",
        "spread": spread,
        "end to end": difference,
        "agrees": difference <= BARS[torch.float32],
    }


def random_frame(height: int, width: int) -> np.ndarray:
    frame = cv2.GaussianBlur(np.random.default_rng(0).normal(size=(height, width, 3)), (0, 0), 5)
    return (127 + 1000 * frame).clip(0, 255).astype(np.uint8)


if __name__ == "__main__":
    main()
