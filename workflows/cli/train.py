"""`moseg train`."""

import os
from typing import Annotated

import typer

from moseg.schemas.errors import InputError
from moseg.workflows.cli import completion
from moseg.workflows.cli.options import DEFAULT_STORE, QuietOption
from moseg.workflows.config.default_store import default_store

_PANEL = "Videos without labels"


def train(
    out: Annotated[
        str, typer.Option("--out", "-o", help="ONNX file to write; its recipe lies beside it.", metavar="FILE")
    ] = "motion_network.onnx",
    folder: Annotated[
        str,
        typer.Option(
            "--folder", help="Scenes, checkpoint and curve; the same command goes on from it.", metavar="FOLDER"
        ),
    ] = ".moseg/training",
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of scenes, random weights and batches.")] = 0,
    scenes: Annotated[
        int | None, typer.Option("--scenes", help="Rendered scenes (default: 4200; with --videos 300).")
    ] = None,
    steps: Annotated[
        int | None, typer.Option("--steps", help="Steps of the optimizer (default: 7000; with --videos 200).")
    ] = None,
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
    start: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="ONNX file to go on from (default: random weights; with --videos the network of this program).",
            metavar="FILE",
        ),
    ] = None,
    videos: Annotated[
        str | None,
        typer.Option(
            "--videos",
            help="Go on from a trained network on the videos in this folder, which need no labels.",
            metavar="FOLDER",
            rich_help_panel=_PANEL,
        ),
    ] = None,
    store: Annotated[
        str,
        typer.Option(
            "--store",
            help="Artifact store of the cues of these videos.",
            metavar="FOLDER",
            show_default="$MOSEG_STORE, else in your cache folder",
            rich_help_panel=_PANEL,
        ),
    ] = DEFAULT_STORE,
    quiet: QuietOption = False,
) -> None:
    """Train the network that finds moving pixels, on scenes that are rendered for it or on videos without labels.

    Nothing is downloaded and no real label is used. By default it starts from random weights, and scenes take 6 GB of
    the folder. The result is used by `--set motion_network.weights=FILE`.

    Examples
    --------
    moseg train --out network.onnx --folder training
    moseg train --out small.onnx --scenes 1000 --steps 1000
    moseg train --from network.onnx --out further.onnx --set rate=0.0003
    moseg train --videos my-videos --out mine.onnx --folder my-training
    """
    from moseg.workflows.api.training import run_scene_training, run_video_training

    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    chosen = [*map(_read_setting, settings or ()), ("scenes", scenes), ("steps", steps)]
    common = (out, folder, seed, workers or cores, threads or cores, device, quiet, chosen)
    if videos is None:
        if store:
            raise InputError("no videos to go on with", where="--store", got=store, expected="--videos FOLDER too")
        done = run_scene_training(start, *common)
    else:
        done = run_video_training(videos, start or "", store or default_store(), *common)
    print(f"{done.onnx}: {_describe(done.scores)}; recipe in {done.recipe}")


def _read_setting(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise InputError("not a setting", where="--set", got=text, expected="name=value")
    return name.strip(), value.strip()


def _describe(scores: dict[str, float | None]) -> str:
    found = "nothing moves in them" if scores["J"] is None else f"J {scores['J']:.1f}"
    return f"{found} on scenes that were held out, loss {scores['loss']:.3f}"
