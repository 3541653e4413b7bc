"""Training of the motion network on clips of videos without labels, from a trained network."""

import copy
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moseg.schemas.parameters import NetworkTrainingParams, VideoTrainingParams
from moseg.workflows.process.devices import current_device
from moseg.workflows.process.resources import pin_threads
from moseg.workflows.training.clip_files import read_clip
from moseg.workflows.training.drawing import draw_shards
from moseg.workflows.training.rendered_scenes import draw_batch, scene_shards, score_scenes, validation_shards
from moseg.workflows.training.result import Trained, write_result
from moseg.workflows.training.sample_reader import SampleReader
from moseg.workflows.training.shards import DRAWING_VERSION
from moseg.workflows.training.start import Start
from moseg.workflows.training.steps import take_steps

if TYPE_CHECKING:
    from torch import Tensor

    from moseg.tasks.motion_network.unet import MotionUNet
    from moseg.tasks.network_training.clips import Clip


def train_on_clips(
    out: Path,
    folder: Path,
    start: Start,
    clips: Sequence[Path],
    params: VideoTrainingParams,
    seed: int,
    workers: int,
    threads: int,
    quiet: bool,
    settings: dict[str, Any],
) -> Trained:
    """Train on clips and rendered scenes, and write the network; what is finished in `folder` is not done again.

    Parameters
    ----------
    out, folder, seed, workers, threads, quiet
        As of `train_on_scenes`.
    start : Start
    clips : sequence of Path
    params : VideoTrainingParams
    settings : dict
        What the clips depend on, as in JSON.

    Raises
    ------
    InputError
        A file cannot be written, or the folder has the checkpoint of another training.
    ClusterError
        A process that drew scenes ended.
    """
    import torch

    from moseg.tasks.network_training.learner import Learner

    common = {name: getattr(params, name) for name in ("steps", "rate", "scenes", "textures", "average", "interval")}
    own = NetworkTrainingParams(**common, batch=params.batch, validation_scenes=min(100, params.scenes), warm_up=20)
    shards, held_out = scene_shards(folder, own, seed), validation_shards(folder, own, seed)
    draw_shards([*shards, *held_out], workers, quiet)
    pin_threads(threads)
    torch.set_num_threads(threads)
    device = current_device()
    before = copy.deepcopy(start.network).to(device, memory_format=torch.channels_last).eval()
    # The normalisations are merged into the convolutions: there are no statistics to learn.
    learner = Learner(start.network, own, device, normalises=False)
    reader = SampleReader(device)

    def loss_of_step(step: int) -> "Tensor":
        clip = read_clip(clips[np.random.default_rng([seed, step, 1]).integers(len(clips))])
        replayed = _keep_loss(learner.logits, before, draw_batch(reader, shards, own, seed, step).channels)
        return params.replay * replayed + _clip_loss(learner.logits, before, clip, params, device)

    drawn = {"seed": seed, "scenes_version": DRAWING_VERSION, "start": start.sha256}
    settings = {**drawn, **settings, **params.model_dump(mode="json")}
    validate = partial(score_scenes, learner, reader, held_out)
    curve = take_steps(learner, own, loss_of_step, validate, folder, settings, quiet, shows_start=True)
    return write_result(learner.average, out, settings, curve)


def _keep_loss(logits: "Callable[[Tensor], Tensor]", before: "MotionUNet", rendered: "Tensor") -> "Tensor":
    """Return the cross-entropy with the network of the start on rendered samples float32 (sample, channel, y, x).

    Their labels would train it on: at this rate and on so few scenes it gets worse, as measured.
    """
    import torch

    from moseg.tasks.network_training.clip_loss import keep_loss
    from moseg.tasks.network_training.learner import apply_network

    with torch.no_grad():
        known = apply_network(before, rendered)
    return keep_loss(logits(rendered), known)


def _clip_loss(logits: "Callable[[Tensor], Tensor]", before: "MotionUNet", clip: "Clip", params, device) -> "Tensor":
    import torch

    from moseg.tasks.network_training.batch import pad_channels
    from moseg.tasks.network_training.clip_loss import clip_losses, weighted_sum
    from moseg.tasks.network_training.learner import apply_network

    height, width = clip.channels.shape[2:]
    channels = pad_channels(torch.from_numpy(clip.channels).to(device))
    with torch.no_grad():
        known = apply_network(before, channels)[:, :height, :width]
    return weighted_sum(clip_losses(logits(channels)[:, :height, :width], known, clip, params.rank), params)
