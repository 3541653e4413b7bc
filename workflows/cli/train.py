"""`moseg train`."""

import os
from typing import Annotated

import typer

from moseg.schemas.errors import InputError
from moseg.workflows.cli import completion
from moseg.workflows.cli.options import QuietOption


def train(
    out: Annotated[
        str, typer.Option("--out", help="ONNX file to write; its recipe lies beside it.", metavar="FILE")
    ] = "motion_network.onnx",
    folder: Annotated[
        str,
        typer.Option(
            "--folder", help="Scenes, checkpoint and curve; the same command goes on from it.", metavar="FOLDER"
        ),
    ] = ".moseg/training",
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of scenes, random weights and batches.")] = 0,
    scenes: Annotated[int | None, typer.Option("--scenes", help="Rendered scenes (default: 9000).")] = None,
    steps: Annotated[int | None, typer.Option("--steps", help="Steps of the optimizer (default: 7000).")] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            help="Another parameter of the training; may be repeated.",
            metavar="NAME=VALUE",
            show_default=False,
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, help="Processes that draw scenes (default: one per CPU).")
    ] = None,
    threads: Annotated[
        int | None, typer.Option("--threads", min=1, help="Threads of the training (default: one per CPU).")
    ] = None,
    device: Annotated[
        str,
        typer.Option(
            "--device",
            help="Where the network is trained: auto, cpu, cuda, cuda:N or mps; auto takes a GPU.",
            metavar="NAME",
            autocompletion=completion.complete_device,
        ),
    ] = "auto",
    quiet: QuietOption = False,
) -> None:
    """Train the network that finds moving pixels, on scenes that are rendered for it.

    Nothing is downloaded and no real label is used. Scenes take 12 GB of the folder. The result is used by
    `--set motion_network.weights=FILE`.

    Examples
    --------
    moseg train --out network.onnx --folder training
    moseg train --out small.onnx --scenes 1000 --steps 1000
    """
    from moseg.workflows.api.training import run_scene_training

    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    chosen = [*map(_read_setting, settings or ()), ("scenes", scenes), ("steps", steps)]
    done = run_scene_training(out, folder, seed, workers or cores, threads or cores, device, quiet, chosen)
    print(f"{done.onnx}: {_describe(done.scores)}; recipe in {done.recipe}")


def _read_setting(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise InputError("not a setting", where="--set", got=text, expected="name=value")
    return name.strip(), value.strip()


def _describe(scores: dict[str, float | None]) -> str:
    found = "nothing moves in them" if scores["J"] is None else f"J {scores['J']:.1f}"
    return f"{found} on scenes that were held out, loss {scores['loss']:.3f}"
