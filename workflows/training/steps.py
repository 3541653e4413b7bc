"""The steps of a training, with checkpoints and validations at intervals."""

import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from moseg.schemas.parameters import NetworkTrainingParams
from moseg.workflows.exports.write_text import write_text
from moseg.workflows.process.progress import StageProgress
from moseg.workflows.training.checkpoint import Checkpoint, read_checkpoint

if TYPE_CHECKING:
    from torch import Tensor

    from moseg.tasks.network_training.learner import Learner

CHECKPOINT_STEPS = 50
"""Steps between checkpoints, which are also written with every validation."""
CURVE = "curve.json"


def take_steps(
    learner: "Learner",
    params: NetworkTrainingParams,
    loss_of_step: Callable[[int], "Tensor"],
    validate: Callable[[], Mapping[str, float | None]],
    folder: Path,
    settings: dict[str, Any],
    quiet: bool,
    shows_start: bool = False,
) -> list[dict[str, float | None]]:
    """Train to the end, from the checkpoint in `folder` if there is one.

    Parameters
    ----------
    learner : Learner
    params : NetworkTrainingParams
    loss_of_step : callable
        Loss of a step, counted from 0. It must depend on nothing but the step, so that an interruption changes nothing.
    validate : callable
        Scores of the moving average.
    folder : Path
        Of ``checkpoint.pt`` and ``curve.json``.
    settings : dict
        All that the result depends on, as in JSON: a checkpoint with others is refused.
    quiet : bool
        Whether no progress is shown.
    shows_start : bool
        Whether the curve begins with the scores before the first step.

    Returns
    -------
    curve : list of dict
        Step, mean loss since the entry before it, rate, scores, and seconds of this training since it was last started.

    Raises
    ------
    InputError
        A checkpoint cannot be read, is of another training, or cannot be written.
    """
    from moseg.tasks.network_training.learner import learning_rate

    curve: list[dict[str, float | None]] = []
    losses: list[float | Tensor] = []
    found = read_checkpoint(folder, settings)
    if found is not None:
        learner.load(found.learner)
        curve, losses = list(found.curve), list(found.losses)
    elif shows_start:
        curve.append({"step": 0, "loss": None, "rate": 0.0, **validate(), "seconds": 0.0})
    started = time.monotonic()
    with StageProgress({"steps": params.steps}, quiet, "steps", is_detailed=True) as progress:
        progress.advance("steps", learner.step)
        while learner.step < params.steps:
            step = learner.step
            losses.append(learner.learn(lambda step=step: loss_of_step(step)))
            is_shown = learner.step % params.interval == 0 or learner.step == params.steps
            is_kept = is_shown or learner.step % CHECKPOINT_STEPS == 0
            if is_kept:
                # Only now, because it waits for the device.
                losses = [float(loss) for loss in losses]
            if is_shown:
                rate = learning_rate(step, params)
                scores = validate()
                seconds = round(time.monotonic() - started, 1)
                entry = {"step": learner.step, "loss": sum(losses) / len(losses), "rate": rate}
                curve.append({**entry, **scores, "seconds": seconds})
                losses = []
                write_text(folder / CURVE, json.dumps(curve, indent=1) + "\n")
            if is_kept:
                Checkpoint(learner.state(), curve, losses).write(folder, settings)
            progress.advance("steps")
    return curve
