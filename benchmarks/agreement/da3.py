"""Agreement of our Depth Anything 3 with the authors' code.

Run ``python benchmarks/agreement/da3.py --official DIR [--out FILE]``, DIR being a checkout of
ByteDance-Seed/Depth-Anything-3; einops, addict, omegaconf and torchvision are not needed. Both load the same random
state dict of the authors' complete network and get the same frames. It prints the largest differences as shares of the
spread, and writes them to FILE: of the logarithm of depth at sizes of whole patches; that of the authors' own result if
the frame changes in the last digit; and, from the frame to the map that is stored, of inverse depth at the frame's
size, with the authors' preprocessing, and their depth inverted and resized as ours. Of several views at once it
compares depth, cameras by the decoder, and rays; of frames, the poses and depth that are stored; and the camera that
the authors find in exact rays, of which they draw samples. The script must not be named like the authors' package,
which it imports.
"""

import argparse
import importlib
import json
import sys
import types
from pathlib import Path
from unittest import mock

import cv2
import numpy as np
import torch
import torchvision_parts

from moseg.schemas.parameters import CameraParams, DepthAnything3Params
from moseg.tasks.cameras import estimate_cameras
from moseg.tasks.cameras.rays import cameras_of_rays
from moseg.tasks.cameras.scene_cameras import SceneCameras, decode_cameras
from moseg.tasks.depth import estimate_inverse_depth
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth_anything_3 import (
    build_depth_anything_3,
    build_depth_anything_3_cameras,
    build_depth_anything_3_rays,
)

BARS = {torch.float64: 1e-4, torch.float32: 1e-3}
NETWORKS = {"small": ("vits", 384, 64), "base": ("vitb", 768, 128)}
SIZES = ((518, 518), (140, 238), (280, 504))
# Frames, and the longer side for the network: reduced, enlarged, of whole patches, upright, and of odd ratios.
VIEWS = ((1, (70, 98)), (2, (70, 98)), (3, (98, 70)), (6, (70, 98)))
"""Numbers of views at once, and their sizes; of three and more, the reference is not the first."""
GAPS = (2, 4)
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
        decoder, official.cam_dec = official.cam_dec, None
        document = json.dumps({"model_name": f"da3-{name}"})
        named = {f"model.{key}": value for key, value in tensors.items()}
        checkpoint = Checkpoint("random", named, {"config.json": document})
        ours = build_depth_anything_3(checkpoint)
        rows += [compare_networks(name, official, ours, size) for size in SIZES]
        rows += [compare_frames(name, official, ours, *frames) for frames in FRAMES]
        official.cam_dec = InItsPrecision(decoder)
        both = build_depth_anything_3_cameras(checkpoint), build_depth_anything_3_rays(checkpoint)
        rows += [compare_views(name, official, *both, *views) for views in VIEWS]
        rows.append(compare_video(name, official, both[0]))
    rows.append(compare_rays())
    for row in rows:
        print("  ".join(f"{key} {value:.2g}" if isinstance(value, float) else str(value) for key, value in row.items()))
    if options.out is not None:
        options.out.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    sys.exit(0 if all(row["agrees"] for row in rows) else 1)


def stand_in() -> None:
    """Register the few functions of other packages that the authors' network and preprocessing call."""
    torchvision_parts.stand_in()
    parts = {
        "einops": {"rearrange": rearrange, "einsum": None, "repeat": repeat},
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


def repeat(tensor: torch.Tensor, pattern: str, **sizes: int) -> torch.Tensor:
    """Return a vector repeated along new axes, by the one pattern ``c -> b s 1 c`` that the authors use."""
    if pattern != "c -> b s 1 c":
        raise NotImplementedError(pattern)
    return tensor.expand(sizes["b"], sizes["s"], 1, -1)


class InItsPrecision(torch.nn.Module):
    """The authors' decoder of cameras, whose conversions to float32 are left out."""

    def __init__(self, decoder: torch.nn.Module):
        super().__init__()
        self.decoder = decoder

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        with mock.patch.object(torch.Tensor, "float", lambda tensor: tensor):
            return self.decoder(tokens)


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
    # Fields of view are cut off at 0.
    state["cam_dec.fc_fov.0.bias"] += 1.5
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


def compare_views(
    name: str,
    official: torch.nn.Module,
    with_decoder: torch.nn.Module,
    with_rays: torch.nn.Module,
    num_views: int,
    size: tuple[int, int],
) -> dict:
    """Return the figures of several views at once, in both precisions: depth, cameras and rays."""
    frames = random_video(num_views, *size)
    pixels = torch.from_numpy(frames).permute(0, 3, 1, 2).double() / 127.5 - 1
    figures: dict = {"network": name, "compared": f"{num_views} views, {size[1]}x{size[0]}"}
    agrees = True
    for dtype, bar in BARS.items():
        theirs, decoder, rays, images = (each.to(dtype) for each in (official, with_decoder, with_rays, pixels))
        with torch.inference_mode():
            wanted = theirs(images[None], ref_view_strategy="middle")
            features, _ = theirs.backbone(images[None], ref_view_strategy="middle")
            dense = theirs.head(features, *size, patch_start_idx=0)
            views, views_by_rays = decoder(images), rays(images)
        cameras = decode_cameras(views.cameras.numpy())
        wanted_rays = torch.cat([dense.ray[0], (dense.ray_conf[0] - 1).log()[..., None]], dim=3)
        differences = {
            "depth": difference(views.depth, wanted.depth[0].log()),
            "depth beside rays": difference(views_by_rays.depth, wanted.depth[0].log()),
            "pose": difference(torch.from_numpy(extrinsics(cameras)), wanted.extrinsics[0]),
            "focal length": difference(
                torch.from_numpy(cameras.focal).log(),
                (wanted.intrinsics[0, :, [0, 1], [0, 1]].double() / torch.tensor(size[::-1])).log(),
            ),
            "rays": difference(views_by_rays.rays.movedim(1, 3), wanted_rays),
        }
        kind = str(dtype).removeprefix("torch.")
        figures |= {f"{what}, {kind}": value for what, value in differences.items()}
        agrees &= max(differences.values()) <= bar
    return figures | {"agrees": agrees}


def compare_video(name: str, official: torch.nn.Module, ours: torch.nn.Module) -> dict:
    """Return the figures from RGB frames to the poses and the inverse depth that are stored."""
    size, side = (120, 213), 196
    frames = random_video(6, *size)
    processor = importlib.import_module("depth_anything_3.utils.io.input_processor").InputProcessor()
    pixels, _, _ = processor(list(frames), process_res=side, process_res_method="upper_bound_resize", sequential=True)
    with torch.inference_mode():
        wanted = official(pixels[None], ref_view_strategy="middle")
    depth = torch.nn.functional.interpolate(1 / wanted.depth, size=size, mode="bilinear")[0]
    got = estimate_cameras(ours, frames, GAPS, CameraParams(), DepthAnything3Params(side=side))
    to_camera = np.concatenate([wanted.extrinsics[0].numpy(), np.tile([[[0, 0, 0, 1]]], (len(frames), 1, 1))], axis=1)
    poses = [to_camera[start + gap] @ np.linalg.inv(to_camera[start]) for start, gap in got.pairs]
    figures = {
        "inverse depth": difference(torch.from_numpy(got.inverse_depth), depth),
        "pose": difference(torch.from_numpy(got.pose), torch.from_numpy(np.array(poses)[:, :3])),
    }
    compared = f"{len(frames)} frames of {size[1]}x{size[0]}, {pixels.shape[3]}x{pixels.shape[2]} for the network"
    return {
        "network": name,
        "compared": compared,
        **figures,
        "agrees": max(figures.values()) <= BARS[torch.float32],
    }


def compare_rays() -> dict:
    """Return the figures of the cameras that both find in exact rays, some of them of other cameras."""
    rng = np.random.default_rng(0)
    rows, columns, views = 80, 120, 4
    turns, _ = np.linalg.qr(np.eye(3) + 0.2 * rng.normal(size=(views, 3, 3)))
    turns *= np.sign(np.einsum("sii->si", turns))[:, None]
    true = SceneCameras(turns, rng.normal(size=(views, 3)), rng.uniform(0.5, 1.2, (views, 2)))
    x, y = np.meshgrid(*((2 * np.arange(side) + 1 - side) / side for side in (columns, rows)))
    rays = np.empty((views, 7, rows, columns), np.float32)
    for view, (turn, centre, focal) in enumerate(zip(*true, strict=True)):
        seen = np.stack([x / focal[0] / 2, y / focal[1] / 2, np.ones_like(x)])
        rays[view, :3] = np.einsum("ij,jyx->iyx", turn, seen)
        rays[view, 3:6] = centre[:, None, None]
    rays[:, 6] = rng.normal(size=rays[:, 6].shape)
    # A mover.
    rays[:, :3, :20, :30] += 1
    find = importlib.import_module("depth_anything_3.utils.ray_utils").get_extrinsic_from_camray
    torch.manual_seed(0)
    tensor = torch.from_numpy(rays)
    poses, focal, _ = find(tensor[None, :, :6].movedim(2, 4), tensor[None, :, 6].exp()[..., None] + 1, rows, columns)
    got = cameras_of_rays(rays)
    figures = {
        "rotation": float(np.abs(got.rotation - poses[0, :, :3, :3].numpy()).max()),
        "centre": float(np.abs(got.centre - poses[0, :, :3, 3].numpy()).max()),
        "focal length": float(np.abs(got.focal - focal[0].numpy() / 2).max()),
        "rotation, ours to the true one": float(np.abs(got.rotation - true.rotation).max()),
    }
    return {"network": "any", "compared": "cameras of exact rays", **figures, "agrees": max(figures.values()) < 1e-3}


def extrinsics(cameras: SceneCameras) -> np.ndarray:
    """Return [R | t] (S, 3, 4) from the scene to each camera."""
    turned = cameras.rotation.transpose(0, 2, 1)
    return np.concatenate([turned, -turned @ cameras.centre[:, :, None]], axis=2)


def difference(got: torch.Tensor, wanted: torch.Tensor) -> float:
    """Return the largest difference as a share of the spread."""
    return float((got.double() - wanted.double()).abs().max() / wanted.double().std())


def random_video(num_frames: int, height: int, width: int) -> np.ndarray:
    """Return frames (F, y, x, 3) of one large picture, each a little farther right."""
    picture = random_frame(height, width + 5 * num_frames)
    return np.stack([picture[:, 5 * frame : 5 * frame + width] for frame in range(num_frames)])


def random_frame(height: int, width: int) -> np.ndarray:
    frame = cv2.GaussianBlur(np.random.default_rng(0).normal(size=(height, width, 3)), (0, 0), 5)
    return (127 + 1000 * frame).clip(0, 255).astype(np.uint8)


if __name__ == "__main__":
    main()
