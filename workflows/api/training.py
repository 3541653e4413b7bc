"""Training of the motion network, from options to files."""

from collections.abc import Iterable
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import NetworkTrainingParams
from moseg.schemas.spelling import closest
from moseg.workflows.process.devices import set_device
from moseg.workflows.process.resources import check_bearable
from moseg.workflows.training.requirements import require_packages
from moseg.workflows.training.result import Trained, check_result

Params = TypeVar("Params", bound=BaseModel)


def run_scene_training(
    out: str,
    folder: str,
    seed: int,
    workers: int,
    threads: int,
    device: str,
    quiet: bool,
    settings: Iterable[tuple[str, object]],
) -> Trained:
    """Train the network on rendered scenes and write it to `out`; see `train_on_scenes`."""
    from moseg.workflows.training.rendered_scenes import train_on_scenes

    params = read_params(NetworkTrainingParams, settings)
    path = prepare(out, workers, threads, device)
    return train_on_scenes(path, Path(folder), params, seed, workers, threads, quiet)


def prepare(out: str, workers: int, threads: int, device: str) -> Path:
    """Check all that may be wrong before a training, and return the path of its result; raises InputError."""
    check_bearable(workers, "workers")
    check_bearable(threads, "threads")
    require_packages()
    set_device(device)
    return check_result(out)


def read_params(model: type[Params], settings: Iterable[tuple[str, object]]) -> Params:
    """Return the parameters of a training; settings without a value are left at their default; raises InputError."""
    values = {name: value for name, value in settings if value is not None}
    try:
        return model.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        name = str(first["loc"][0])
        if first["type"] == "extra_forbidden":
            close = closest(name, model.model_fields)
            expected = f"did you mean {close!r}?" if close else ", ".join(model.model_fields)
            raise InputError("unknown parameter of the training", got=repr(name), expected=expected) from error
        expected = first["msg"].removeprefix("Input should be ").partition(", unable to parse")[0]
        raise InputError("bad parameter", where=name, got=repr(first["input"]), expected=expected) from error
