"""What the shell offers when a value is being typed: names of data sets, methods, runs, weights, parameters.

Completion cannot report an error: where the names cannot be read, none are offered.
"""

import os
from collections.abc import Callable, Iterable

import typer

from moseg.schemas.errors import MosegError

Completer = Callable[[typer.Context, str], list[str]]
MAX_RUNS = 30


def offer(find: Callable[[typer.Context], Iterable[str]], *, is_list: bool = False) -> Completer:
    """Return a completer of the names that `find` gives; where the value is a list with commas, of its last name."""

    def complete(context: typer.Context, incomplete: str) -> list[str]:
        before, comma, start = incomplete.rpartition(",") if is_list else ("", "", incomplete)
        try:
            names = list(find(context))
        except (MosegError, OSError):
            return []
        return [f"{before}{comma}{name}" for name in names if name.startswith(start)]

    return complete


def _datasets(context: typer.Context) -> Iterable[str]:
    from moseg.workflows.datasets.registry import DATASETS

    return DATASETS


def _sequences(context: typer.Context) -> Iterable[str]:
    from moseg.schemas.configs import PipelineConfig
    from moseg.workflows.datasets import open_dataset

    given = context.params
    name = given.get("dataset") or "synthetic"
    root, listed = given.get("root"), given.get("list_file")
    return open_dataset(name, root, None, listed, max_side=PipelineConfig().max_side).names


def _runs(context: typer.Context) -> Iterable[str]:
    from moseg.store import open_store
    from moseg.workflows.config.default_store import default_store
    from moseg.workflows.runlog.status import LATEST, list_runs

    url = context.params.get("store") or default_store()
    # Over a network a listing takes too long for completion.
    if "://" in url and not url.startswith("file://"):
        return [LATEST]
    return [LATEST, *list_runs(open_store(url, create=False))[:MAX_RUNS]]


def _weights(context: typer.Context) -> Iterable[str]:
    from moseg.workflows.weights.folder import open_weights

    return open_weights(os.environ).items


def _settings(context: typer.Context) -> Iterable[str]:
    from moseg.workflows.config.parameters import list_parameters

    for name, parameter in list_parameters().items():
        yield f"{name}="
        yield from (f"{name}={choice}" for choice in parameter.choices)


def _stages(context: typer.Context) -> Iterable[str]:
    from moseg.workflows.config.parameters import list_parameters, list_stages

    return [*list_stages(), *list_parameters()]


complete_dataset = offer(_datasets)
complete_sequences = offer(_sequences, is_list=True)
complete_device = offer(lambda context: ("auto", "cpu", "cuda", "mps"))
complete_setting = offer(_settings)
complete_stage = offer(_stages)
complete_run = offer(_runs)
complete_weights = offer(_weights)
complete_weights_list = offer(_weights, is_list=True)
