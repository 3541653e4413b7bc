"""Agreement of our PIPs with the published code on shared random weights.

Run ``python benchmarks/agreement/pips.py --official DIR``, where DIR is a checkout of github.com/aharley/pips. Both
networks read one random state dict and follow the same points, some of them beyond the frame's edge, through a
window of random frames. Exits with 1 if they differ by more than the bars below.

The published code expects a GPU and single precision, and takes one layer, a mean, from a library. Here it is run on
the CPU, in either precision, with that layer in the library's place.
"""

import argparse
import sys
import types
from collections.abc import Iterator
from contextlib import contextmanager
from unittest import mock

import numpy as np
import torch

from moseg.schemas.parameters import TrackParams
from moseg.schemas.parameters.pips import PipsParams
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.pips import Pips, Resolution, build_pips
from moseg.tasks.tracks.pips import track_points_pips

NUM_FRAMES, HEIGHT, WIDTH, NUM_POINTS = 8, 136, 200, 200
ITERATIONS, MAX_SIDE = 6, 152
CASES = ((torch.float64, 1.0, 1e-4), (torch.float32, 0.05, 1e-3))
"""Precision, scale of the layer that moves points, and largest difference of a point, px, and of a visibility's logit.

Motion is encoded by sines of up to 968 rad/cell, so where random weights move points by tens of pixels, an iteration
makes a difference ten times larger: from rounding in single precision to a pixel in six. A small layer keeps it there.
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--official", required=True, metavar="DIR", help="checkout of github.com/aharley/pips")
    parser.add_argument("--seeds", type=int, default=2, help="random networks that are compared")
    options = parser.parse_args()
    torch.set_num_threads(1)
    published_type = import_published(options.official)
    print(f"{'type':15} {'scale':>5} {'seed':>4} {'points, px':>11} {'moved, px':>10} {'visibility':>11}")
    agrees = True
    for dtype, scale, bar in CASES:
        for seed in range(options.seeds):
            torch.manual_seed(seed)
            published = published_type(S=NUM_FRAMES, stride=4).eval().requires_grad_(False)
            for tensor in published.delta_block.to_delta[-1].parameters():
                tensor *= scale
            ours = build_pips(Checkpoint("random", published.state_dict())).to(dtype)
            images = random_frames()
            points = torch.rand(NUM_POINTS, 2, dtype=dtype) * torch.tensor([WIDTH + 20, HEIGHT + 20]) - 10
            expected = follow_as_published(published.to(dtype), images, points)
            got = follow(ours, images, points)
            differences = [(a - b).abs().max().item() for a, b in zip(got, expected, strict=True)]
            moved = (expected[0] - points[:, None]).norm(dim=-1).max().item()
            print(f"{dtype!s:15} {scale:5} {seed:4} {differences[0]:11.1e} {moved:10.1f} {differences[1]:11.1e}")
            agrees &= max(differences) <= bar
            if dtype == torch.float32:
                num_points, difference = compare_frames(published, ours, images)
                print(f"{dtype!s:15} {scale:5} {seed:4} {difference:11.1e} end to end, {num_points} points seen")
                agrees &= difference <= bar and num_points > 30
    return 0 if agrees else 1


def compare_frames(published: torch.nn.Module, ours: Pips, images: torch.Tensor) -> tuple[int, float]:
    """Return the points visible in all frames, and the largest difference, px, on frames that both reduce; one window.

    Only our pipeline chooses the start of points and the end of tracks; the authors' demo resizes by torch.
    """
    frames = images.numpy()
    masks = np.ones((NUM_FRAMES, HEIGHT, WIDTH), np.uint16)
    params = PipsParams(max_side=MAX_SIDE, min_visibility=0.0)
    tracks = track_points_pips(ours, frames, masks, TrackParams(border=0), params, np.random.default_rng(0))
    lasting = tracks.visible.all(axis=1)
    found = tracks.points[lasting]
    resolution = Resolution.capped((HEIGHT, WIDTH), MAX_SIDE, ours.config.min_side)
    starts = torch.from_numpy(resolution.to_network(found[:, 0]).astype(np.float32))
    with torch.inference_mode(), published_precision(torch.float32):
        pixels = images.permute(0, 3, 1, 2).float()
        pixels = torch.nn.functional.interpolate(pixels, resolution.network, mode="bilinear")
        wanted = published(starts[None], pixels[None], iters=ITERATIONS)[0][-1][0].transpose(0, 1).numpy()
    return int(lasting.sum()), float(np.abs(resolution.to_frame(wanted) - found).max())


def import_published(folder: str) -> type[torch.nn.Module]:
    """Return the published network's class."""
    sys.path.insert(0, folder)
    layers = types.ModuleType("einops.layers.torch")
    layers.Rearrange, layers.Reduce = None, lambda pattern, kind: FrameMean()
    library = types.ModuleType("einops")
    library.rearrange = library.repeat = None
    stand_in = {"einops": library, "einops.layers": types.ModuleType("einops.layers"), "einops.layers.torch": layers}
    with mock.patch.dict(sys.modules, stand_in):
        from nets.pips import Pips as Published
    return Published


class FrameMean(torch.nn.Module):
    """Mean of (B, frames, C) over the frames."""

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return x.mean(dim=1)


@contextmanager
def published_precision(dtype: torch.dtype) -> Iterator[None]:
    """Run the published code in precision `dtype` instead of float32, and on the CPU."""
    default = torch.get_default_dtype()
    with (
        mock.patch.object(torch, "float32", dtype),
        mock.patch.object(torch.Tensor, "float", lambda tensor: tensor.to(dtype)),
        mock.patch.object(torch.Tensor, "cuda", lambda tensor: tensor),
    ):
        torch.set_default_dtype(dtype)
        try:
            yield
        finally:
            torch.set_default_dtype(default)


def random_frames() -> torch.Tensor:
    """Return smooth random frames, uint8 (S, y, x, 3)."""
    noise = torch.rand(NUM_FRAMES, 3, HEIGHT // 8, WIDTH // 8)
    smooth = torch.nn.functional.interpolate(noise, (HEIGHT, WIDTH), mode="bicubic").clamp(0, 1)
    return (255 * smooth).to(torch.uint8).permute(0, 2, 3, 1).contiguous()


@torch.inference_mode()
def follow_as_published(network, images: torch.Tensor, points: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Return points (N, S, 2) and logits of visibility (N, S) of the published code."""
    with published_precision(points.dtype):
        frames = images.permute(0, 3, 1, 2)[None].to(points.dtype)
        predictions, _, visibility, _ = network(points[None], frames, iters=ITERATIONS)
    return predictions[-1][0].transpose(0, 1), visibility[0].T


@torch.inference_mode()
def follow(network: Pips, images: torch.Tensor, points: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Return points (N, S, 2) and logits of visibility (N, S) of our code."""
    pyramid = network.encode(images)
    return network(pyramid, points, network.appearances(pyramid, points), ITERATIONS)


if __name__ == "__main__":
    sys.exit(main())
