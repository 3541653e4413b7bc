"""Training of the motion network on rendered scenes, from random weights or from a trained network."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moseg.schemas.parameters import NetworkTrainingParams
from moseg.workflows.process.devices import current_device
from moseg.workflows.process.resources import pin_threads
from moseg.workflows.training.drawing import draw_shards
from moseg.workflows.training.result import Trained, write_result
from moseg.workflows.training.sample_reader import SampleReader
from moseg.workflows.training.shards import DRAWING_VERSION, Shard, plan_shards
from moseg.workflows.training.start import Start
from moseg.workflows.training.steps import take_steps

if TYPE_CHECKING:
    from moseg.tasks.network_training.batch import Batch
    from moseg.tasks.network_training.learner import Learner

_FIRST_VALIDATION = 1000
"""Number of the first shard to validate on, of the seed after that of the training: no texture or scene is shared."""
_VALIDATION_BATCH = 20


def train_on_scenes(
    out: Path,
    folder: Path,
    start: Start | None,
    params: NetworkTrainingParams,
    seed: int,
    workers: int,
    threads: int,
    quiet: bool,
) -> Trained:
    """Draw the scenes, train, and write the network; what is finished in `folder` is not done again.

    Parameters
    ----------
    out : Path
        The ONNX file.
    folder : Path
        Of scenes, checkpoint and curve; 1.3 MB a scene.
    start : Start or None
        None starts from random weights.
    params : NetworkTrainingParams
    seed : int
    workers, threads : int
        Processes that draw scenes, and threads of the training.
    quiet : bool
        Whether no progress is shown.

    Raises
    ------
    InputError
        A file cannot be written, or the folder has the checkpoint of another training.
    ClusterError
        A process that drew scenes ended.
    """
    import torch

    from moseg.tasks.motion_network.unet import MotionUNet
    from moseg.tasks.network_training.learner import Learner

    shards = scene_shards(folder, params, seed)
    held_out = validation_shards(folder, params, seed)
    draw_shards([*shards, *held_out], workers, quiet)
    pin_threads(threads)
    torch.set_num_threads(threads)
    torch.manual_seed(seed)
    network = MotionUNet() if start is None else start.network
    learner = Learner(network, params, current_device(), normalises=start is None)
    reader = SampleReader(learner.device)
    settings = {**scene_settings(params, seed), "start": "random weights" if start is None else start.sha256}
    curve = take_steps(
        learner,
        params,
        lambda step: learner.label_loss(draw_batch(reader, shards, params, seed, step)),
        partial(score_scenes, learner, reader, held_out),
        folder,
        settings,
        quiet,
        shows_start=start is not None,
    )
    return write_result(learner.average, out, settings, curve)


def scene_settings(params: NetworkTrainingParams, seed: int) -> dict[str, Any]:
    """Return what a training on scenes depends on, as in JSON."""
    return {"seed": seed, "scenes_version": DRAWING_VERSION, **params.model_dump(mode="json")}


def scene_shards(folder: Path, params: NetworkTrainingParams, seed: int) -> tuple[Shard, ...]:
    """Return the shards to train on."""
    return plan_shards(folder / "scenes", seed, 0, params.scenes, params.textures)


def validation_shards(folder: Path, params: NetworkTrainingParams, seed: int) -> tuple[Shard, ...]:
    """Return the shards to validate on."""
    return plan_shards(folder / "scenes", seed + 1, _FIRST_VALIDATION, params.validation_scenes, params.textures)


def draw_batch(
    reader: SampleReader, shards: Sequence[Shard], params: NetworkTrainingParams, seed: int, step: int
) -> "Batch":
    """Return the batch of a step: random samples of a random shard, which all have the same size."""
    from moseg.tasks.network_training.batch import augment

    rng = np.random.default_rng([seed, step])
    sizes = np.array([shard.num_samples for shard in shards], float)
    shard = shards[rng.choice(len(shards), p=sizes / sizes.sum())]
    rows = np.sort(rng.choice(shard.num_samples, min(params.batch, shard.num_samples), replace=False))
    return augment(reader.read(shard, rows), rng, params.missing)


def score_scenes(learner: "Learner", reader: SampleReader, shards: Sequence[Shard]) -> dict[str, float | None]:
    """Return the scores of the moving average on shards; None for those that no scene gives."""
    from moseg.tasks.network_training.validation import validate

    batches = (
        reader.read(shard, slice(first, first + _VALIDATION_BATCH))
        for shard in shards
        for first in range(0, shard.num_samples, _VALIDATION_BATCH)
    )
    scores = validate(learner.average, batches)
    return {name: None if np.isnan(value) else value for name, value in scores._asdict().items()}
