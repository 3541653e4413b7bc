"""Agreement of our DeAOT with the official one on shared random weights.

    python benchmarks/agreement/deaot.py --official DIR

DIR is a checkout of https://github.com/yoxu515/aot-benchmark (commit 601c138 was used). Both networks load one seeded
state dict of R50-DeAOTL and track the same moving blobs through a video, each with its own engine. The figure is the
largest difference of the networks' logits over all frames and groups; labels must be identical. Exit code 1 if it is
above the bar.
"""

import argparse
import sys
import types
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import torch
from torch.nn import functional as F

from moseg.schemas.parameters.deaot import DeaotParams
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.deaot import Deaot, DeaotConfig, build_deaot
from moseg.tasks.proposals.deaot import propagate_masks

BAR = 1e-5
UNBOUNDED = 10**6


class Case(NamedTuple):
    """Video for the comparison; `size` is (y, x)."""

    num_frames: int
    size: tuple[int, int]
    num_objects: int
    params: DeaotParams


CASES = {
    "4 objects, memory every 5 frames": Case(16, (193, 257), 4, DeaotParams(memory_frames=UNBOUNDED)),
    "10 objects, memory every 2 frames, resized": Case(
        14, (150, 214), 10, DeaotParams(memory_every=2, memory_frames=UNBOUNDED)
    ),
    "23 objects, 3 groups": Case(14, (161, 225), 23, DeaotParams(memory_frames=UNBOUNDED)),
    "13 objects, 2 groups, shrunk": Case(14, (240, 320), 13, DeaotParams(max_side=208, memory_frames=UNBOUNDED)),
}


def random_state(seed: int) -> dict[str, torch.Tensor]:
    """Return a state dict of R50-DeAOTL whose signals neither vanish nor explode, with distinct objects."""
    rng = np.random.default_rng(seed)
    with torch.device("meta"):
        shapes = {name: tuple(value.shape) for name, value in Deaot(DeaotConfig()).state_dict().items()}
    state = {}
    for name, shape in shapes.items():
        values = rng.standard_normal(shape)
        if name.endswith("running_var"):
            values = rng.uniform(0.5, 1.5, shape)
        elif len(shape) > 1:
            values *= (1.5 / np.prod(shape[1:])) ** 0.5
        elif name.endswith("weight"):
            values = (0.4 if ".bn3." in name else 1.0) * (1 + 0.2 * values)
        else:
            values *= 0.1
        # What follows keeps labels apart: image features are the same for all of them, and so are groups of objects
        # where identities weigh little; labels that tie would be compared by their rounding.
        if "adapter_" in name:
            values *= 0.3
        elif name.endswith("linear_ID_V.weight"):
            values *= 2
        elif name.endswith("relative_emb_k.bias"):
            values[len(values) // 2] += 8
        elif name == "decoder.conv_in.conv.weight":
            values[:, : shape[1] // 2] *= 0.2
        elif name == "decoder.conv_out.weight":
            values = 3 * (values - values.mean(axis=1, keepdims=True))
        state[name] = torch.from_numpy(values.astype(np.float32))
    return state


def moving_blobs(case: Case, seed: int) -> tuple[list[np.ndarray], np.ndarray]:
    """Return textured discs that drift over a textured background, and their labels in the first frame."""
    rng = np.random.default_rng(seed)
    height, width = case.size
    y, x = np.mgrid[:height, :width]
    waves = rng.uniform(0.02, 0.25, (case.num_objects + 1, 3, 2)), rng.uniform(0, 7, (case.num_objects + 1, 3))
    centres = rng.uniform((20, 20), (height - 20, width - 20), (case.num_objects, 2))
    speeds = rng.uniform(-3, 3, (case.num_objects, 2))
    radius = 0.6 * (height * width / case.num_objects / np.pi) ** 0.5
    frames, seeds = [], None
    for t in range(case.num_frames):
        labels = np.zeros(case.size, np.uint16)
        for i, (cy, cx) in enumerate(centres + t * speeds):
            labels[np.hypot(y - cy, x - cx) < radius] = i + 1
        phase = waves[0][labels] @ np.stack([y, x])[..., None].transpose(1, 2, 0, 3)
        frames.append((127 + 120 * np.sin(phase[..., 0] + waves[1][labels] + 0.1 * t)).astype(np.uint8))
        seeds = labels if seeds is None else seeds
    return frames, seeds


def official_labels(network, frames: list[np.ndarray], seeds: np.ndarray, params: DeaotParams) -> Iterator[np.ndarray]:
    """Return labels of all frames but the first, by the official transforms, engine and order of the evaluator."""
    from dataloaders.video_transforms import MultiRestrictSize, MultiToTensor
    from networks.engines import build_engine

    restrict, to_tensor = MultiRestrictSize(None, params.max_side, False, [1.0], True), MultiToTensor()
    engine = build_engine("deaotengine", "eval", aot_model=network, long_term_mem_gap=params.memory_every).eval()
    for index, frame in enumerate(frames):
        sample = to_tensor(restrict({"current_img": frame.astype(np.float32)}))[0]
        image = sample["current_img"][None]
        if index == 0:
            labels = torch.from_numpy(seeds.astype(np.float32))[None, None]
            labels = F.interpolate(labels, size=image.shape[2:], mode="nearest")
            engine.add_reference_frame(image, labels, obj_nums=[int(seeds.max())], frame_step=0)
            continue
        engine.match_propogate_one_frame(image)
        logits = engine.decode_current_logits(seeds.shape)
        labels = torch.argmax(torch.softmax(logits, dim=1), dim=1, keepdim=True).float()
        engine.update_memory(F.interpolate(labels, size=engine.input_size_2d, mode="nearest"))
        yield labels[0, 0].numpy().astype(np.uint16)


def official_network(folder: str, state: dict[str, torch.Tensor]) -> torch.nn.Module:
    """Return the official R50-DeAOTL with these weights."""
    sys.path.insert(0, folder)
    # torchvision is imported there only for the image transforms of training.
    for name in ("torchvision", "torchvision.transforms", "torchvision.transforms.functional"):
        sys.modules.setdefault(name, types.ModuleType(name))
    from configs.models.r50_deaotl import ModelConfig
    from networks.models import build_vos_model

    config = ModelConfig()
    config.TRAIN_ENCODER_FREEZE_AT = 2
    config.TRAIN_LSTT_DROPPATH_SCALING = config.TRAIN_LSTT_DROPPATH_LST = False
    for rate in ("EMB_DROPOUT", "ID_DROPOUT", "DROPPATH", "LT_DROPOUT", "ST_DROPOUT"):
        setattr(config, f"TRAIN_LSTT_{rate}", 0.0)
    network = build_vos_model("deaot", config).eval()
    network.load_state_dict(state, strict=True)
    return network


class LogitRecord:
    """Record of the output of a network's decoder, frame by frame, for all groups of objects."""

    def __init__(self, network: torch.nn.Module):
        self.outputs: list[torch.Tensor] = []
        # A copy, because the official engine overwrites the logits of unused identities.
        network.decoder.register_forward_hook(lambda _, __, output: self.outputs.append(output.clone()))

    def take(self) -> torch.Tensor:
        """Return the logits (group, 1 + max_objects, y, x) since the last call."""
        logits = torch.cat(self.outputs)
        self.outputs.clear()
        return logits


def compare(
    official: torch.nn.Module, ours: Deaot, records: tuple[LogitRecord, LogitRecord], case: Case, seed: int
) -> tuple[bool, str]:
    """Return whether both agree on one video, and print the figures."""
    frames, seeds = moving_blobs(case, seed)
    difference, num_wrong, areas = 0.0, 0, []
    with torch.inference_mode():
        theirs = official_labels(official, frames, seeds, case.params)
        mine = (frame.labels for frame in propagate_masks(ours, frames, seeds, case.params))
        next(mine)
        for labels0, labels1 in zip(theirs, mine, strict=True):
            logits0, logits1 = (record.take() for record in records)
            difference = max(difference, (logits0 - logits1).abs().max().item())
            num_wrong += int((labels0 != labels1).sum())
            areas.append(np.bincount(labels1.ravel(), minlength=case.num_objects + 1) / labels1.size)
    shares = np.mean(areas, axis=0)
    return difference <= BAR and num_wrong == 0, (
        f"{case.num_frames} frames at {case.size[1]}x{case.size[0]}: logits of {logits1.min():.1f} to "
        f"{logits1.max():.1f} differ by {difference:.1e} at most, {num_wrong} labels differ; "
        f"{(shares > 0.005).sum()} of {len(shares)} labels cover over 0.5 %, the largest {shares.max():.0%}, "
        f"{(areas[-1][1:] > 0).sum()} of {case.num_objects} objects last"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--official", required=True, help="checkout of yoxu515/aot-benchmark")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    torch.set_num_threads(1)
    state = random_state(options.seed)
    official = official_network(options.official, state)
    ours = build_deaot(Checkpoint("random", state))
    records, agree = (LogitRecord(official), LogitRecord(ours)), True
    for name, case in CASES.items():
        is_within, figures = compare(official, ours, records, case, options.seed)
        print(f"{name}, {figures}", flush=True)
        agree &= is_within
    return int(not agree)


if __name__ == "__main__":
    sys.exit(main())
