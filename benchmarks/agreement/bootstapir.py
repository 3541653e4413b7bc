"""Agreement of our BootsTAPIR with the published code on shared random weights.

Run ``python benchmarks/agreement/bootstapir.py --official DIR --einshape DIR``, with checkouts of
github.com/google-deepmind/tapnet and of github.com/google-deepmind/einshape, a library that it imports. Both networks
read one random state dict and follow the same points of one frame, some of them near the frame's edge, through smooth
random frames, at each size of the frames. At the end, our kernel is compared with the authors' preprocessing, network
and postprocessing from the RGB frames to what is stored. Exits with 1 if they differ by more than the bars below.

The authors resize frames by mediapy, which calls Pillow's Lanczos filter; so does this script.
"""

import argparse
import sys
import types
from unittest import mock

import numpy as np
import torch
from PIL import Image

from moseg.schemas.parameters import TrackParams
from moseg.schemas.parameters.bootstapir import BootsTapirParams
from moseg.tasks.networks.bootstapir import BootsTapir, build_bootstapir
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.tracks.bootstapir import track_points_bootstapir

NUM_FRAMES, NUM_POINTS = 4, 24
QUERY_FRAME = 1
ITERATIONS = 4
SIDES = (256, 512)
HEIGHT, WIDTH = 240, 427
MOVE_SCALE = 0.1
"""Factor of the layer that moves points: random weights of full size move them by a frame's width in an iteration."""
HIDDEN_LOGITS = (-2.0, -5.5)
"""Bias of the logits of being hidden and of being far off: about half of the points are then visible."""
BARS = {torch.float64: 1e-10, torch.float32: 1e-3}
"""Largest difference of a point, px, and of a logit."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--official", required=True, metavar="DIR", help="checkout of github.com/google-deepmind/tapnet"
    )
    parser.add_argument(
        "--einshape", required=True, metavar="DIR", help="checkout of github.com/google-deepmind/einshape"
    )
    options = parser.parse_args()
    torch.set_num_threads(1)
    published_type = import_published(options.official, options.einshape)
    published = published_type(pyramid_level=1).eval().requires_grad_(False)
    randomise(published)
    ours = build_bootstapir(Checkpoint("random", published.state_dict()))
    print(f"{'type':15} {'side':>5} {'points, px':>11} {'moved, px':>10} {'occlusion':>10} {'uncertainty':>12}")
    agrees = True
    for dtype, bar in BARS.items():
        published.to(dtype), ours.to(dtype)
        for side in SIDES:
            frames = torch.from_numpy(resize(random_frames(), side))
            points = torch.rand(NUM_POINTS, 2, dtype=dtype, generator=torch.Generator().manual_seed(1)) * side
            expected = follow_as_published(published, frames, points)
            got = follow(ours, frames, points)
            differences = [(a - b).abs().max().item() for a, b in zip(got, expected, strict=True)]
            moved = (expected[0] - points[:, None]).norm(dim=-1).max().item()
            logits = f"{differences[1]:10.1e} {differences[2]:12.1e}"
            print(f"{dtype!s:15} {side:5} {differences[0]:11.1e} {moved:10.1f} {logits}", flush=True)
            agrees &= max(differences) <= bar
    for side in (256, 512):
        num_points, difference, num_other, num_seen = compare_frames(published, ours, side)
        num_places = num_points * (NUM_FRAMES - 1)
        print(f"frame to tracks, side {side}: {num_points} points, visible in {num_seen} of {num_places} places;")
        print(f"positions differ by {difference:.1e} px at most, visibility in {num_other} places", flush=True)
        agrees &= difference <= BARS[torch.float32] and num_other == 0 and 0 < num_seen < num_places
    return 0 if agrees else 1


def compare_frames(published: torch.nn.Module, ours: BootsTapir, side: int) -> tuple[int, float, int, int]:
    """Compare what is stored with the authors' tracks, at the size of the frames.

    Only our pipeline chooses the points, sets them where they were chosen, and hides them at the frame's border.

    Returns
    -------
    num_points : int
    difference : float
        Largest difference of a visible position, px.
    num_other : int
        Positions that only one of both says are visible.
    num_seen : int
        Positions that ours says are visible, without the frame in which points were sampled.
    """
    frames = random_frames()
    masks = np.zeros((1, HEIGHT, WIDTH), np.uint16)
    sampling = TrackParams(background_points=NUM_POINTS, border=0)
    params = BootsTapirParams(side=side, iterations=ITERATIONS)
    tracks = track_points_bootstapir(ours, frames, masks, sampling, params, np.random.default_rng(0))
    scale = np.array([side / WIDTH, side / HEIGHT])
    # The authors' (0, 0) is the upper left edge of the frame, ours the centre of its first pixel.
    starts = torch.from_numpy((tracks.points[:, 0] + 0.5) * scale).float()
    with torch.inference_mode():
        video = 2 * torch.from_numpy(resize(frames, side)).float() / 255 - 1
        queries = torch.cat([torch.zeros(len(starts), 1), starts.flip(1)], dim=1)
        out = published(video[None], queries[None])
    wanted = out["tracks"][0].numpy() / scale - 0.5
    visible = ((1 - out["occlusion"][0].sigmoid()) * (1 - out["expected_dist"][0].sigmoid()) > 0.5).numpy()
    inside = ((wanted >= 0) & (wanted <= [WIDTH - 1, HEIGHT - 1])).all(axis=2)
    # The only mask is the first frame's, where points are set; later frames have no mask.
    later = slice(1, None)
    seen = tracks.visible[:, later]
    difference = np.abs(tracks.points[:, later] - wanted[:, later])[seen].max(initial=0)
    return len(starts), float(difference), int((seen != (visible & inside)[:, later]).sum()), int(seen.sum())


def import_published(folder: str, einshape: str) -> type[torch.nn.Module]:
    """Return the published network's class; ``tree`` serves only its online tracking."""
    sys.path[:0] = [folder, einshape]
    with mock.patch.dict(sys.modules, {"tree": types.ModuleType("tree")}):
        from tapnet.torch.tapir_model import TAPIR
    return TAPIR


def randomise(network: torch.nn.Module) -> None:
    """Fill a network with weights of unit gain, so that points move, and some are hidden."""
    generator = torch.Generator().manual_seed(0)
    for name, tensor in network.named_parameters():
        noise = torch.randn(tensor.shape, generator=generator)
        is_gain = tensor.ndim == 1 and name.endswith("weight")
        tensor.copy_(noise / max(tensor[0].numel(), 1) ** 0.5 if tensor.ndim > 1 else 0.1 * noise + is_gain)
    network.torch_pips_mixer.linear_1.weight[:2] *= MOVE_SCALE
    network.torch_cost_volume_track_mods["occ_out"].bias.copy_(torch.tensor(HIDDEN_LOGITS))


def random_frames() -> np.ndarray:
    """Return smooth random frames that move by a few pixels, uint8 (S, y, x, 3)."""
    noise = torch.rand(1, 3, HEIGHT // 8, WIDTH // 8, generator=torch.Generator().manual_seed(2))
    smooth = torch.nn.functional.interpolate(noise, (HEIGHT, WIDTH), mode="bicubic").clamp(0, 1)
    frame = (255 * smooth[0]).to(torch.uint8).permute(1, 2, 0).numpy()
    return np.stack([np.roll(frame, (index, 3 * index), axis=(0, 1)) for index in range(NUM_FRAMES)])


def resize(frames: np.ndarray, side: int) -> np.ndarray:
    """Resize frames (S, y, x, 3) to squares as the authors do."""
    return np.stack([np.array(Image.fromarray(f).resize((side, side), Image.Resampling.LANCZOS)) for f in frames])


@torch.inference_mode()
def follow_as_published(network, frames: torch.Tensor, points: torch.Tensor) -> tuple[torch.Tensor, ...]:
    """Return points (N, S, 2) and both logits (N, S) of the published code."""
    video = frames.to(points.dtype) / 255 * 2 - 1
    times = torch.full((len(points), 1), QUERY_FRAME, dtype=points.dtype)
    # The published code calls .float() where it samples maps and before its mixer.
    with mock.patch.object(torch.Tensor, "float", lambda tensor: tensor.to(points.dtype)):
        out = network(video[None], torch.cat([times, points.flip(1)], dim=1)[None])
    return out["tracks"][0], out["occlusion"][0], out["expected_dist"][0]


@torch.inference_mode()
def follow(network: BootsTapir, frames: torch.Tensor, points: torch.Tensor) -> tuple[torch.Tensor, ...]:
    """Return points (N, S, 2) and both logits (N, S) of our code, in the authors' coordinates."""
    grids = network.encode(frames)
    points = points - 0.5
    appearances = network.appearances(grids, QUERY_FRAME, points)
    result = network(grids, points, QUERY_FRAME, appearances, ITERATIONS)
    return result.points + 0.5, result.occlusion, result.uncertainty


if __name__ == "__main__":
    sys.exit(main())
