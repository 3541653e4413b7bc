"""`moseg weights`: have the networks' weights here before a run needs them, check them, make tiny ones to try with."""

import os
from pathlib import Path
from typing import Annotated

import typer

from moseg.schemas.errors import InputError
from moseg.workflows.cli import completion
from moseg.workflows.cli.named_options import named_option
from moseg.workflows.cli.options import LicenceOption, NonCommercialOption, QuietOption
from moseg.workflows.config.pipeline_choices import choose_preset
from moseg.workflows.process.progress import PATIENCE_SEC, StageProgress

weights_app = typer.Typer(
    help="""The networks' weights: fetch, verify, make tiny ones. `moseg backends` lists them.

    Examples
    --------
    moseg weights fetch --preset paper
    moseg weights verify
    """,
    no_args_is_help=False,
)


@weights_app.command("fetch")
def fetch(
    items: Annotated[
        list[str] | None,
        typer.Argument(
            help="Weights items; `moseg backends` lists them.",
            metavar="[NAME]...",
            autocompletion=completion.complete_weights,
        ),
    ] = None,
    preset: Annotated[
        str | None,
        named_option("--preset", "Every item that this preset uses."),
    ] = None,
    light: Annotated[bool, typer.Option("--light", help="With --preset: the items of its lighter networks.")] = False,
    non_commercial: NonCommercialOption = False,
    accept_licence: LicenceOption = None,
    again: Annotated[
        bool,
        typer.Option("--again", help="Fetch anew also files that are here and that only their first download fixes."),
    ] = False,
    quiet: QuietOption = False,
) -> None:
    """Download what is missing, and replace what is damaged.

    Examples
    --------
    moseg weights fetch --preset paper
    moseg weights fetch --preset modern --light
    moseg weights fetch raft-large pips
    """
    from moseg.workflows.weights.folder import open_weights

    # Asked for by name: what keeps runs from the network is not meant.
    env = {name: value for name, value in os.environ.items() if name != "MOSEG_OFFLINE"}
    weights = open_weights(env, allow_non_commercial=non_commercial, quiet=quiet, accept_licence=accept_licence)
    chosen = [weights.item(name) for name in [*(items or []), *_items_of(preset, light)]]
    if not chosen:
        expected = "weights items, or --preset"
        raise InputError("nothing to fetch", where="moseg weights fetch", got="no item", expected=expected)
    fixed = [item.name for item in chosen if not any(file.is_fixed_by_download for file in item.files)]
    if again and fixed:
        got, expected = f"{', '.join(fixed)}: your own, or fixed by SHA-256", "items that their first download fixes"
        raise InputError("nothing to fetch anew", where="--again", got=got, expected=expected)
    for item in chosen:
        weights.repair(item, again)
        print(f"{item.name}: {weights.folder / item.name}")


@weights_app.command("verify")
def verify(
    items: Annotated[
        list[str] | None,
        typer.Argument(
            help="Weights items (default: all that are here).",
            metavar="[NAME]...",
            autocompletion=completion.complete_weights,
        ),
    ] = None,
    quiet: QuietOption = False,
) -> None:
    """Hash weights that are here and compare them with what they must be; exit code 1 where one is wrong or missing.

    Examples
    --------
    moseg weights verify
    moseg weights verify raft-large
    """
    from moseg.workflows.weights.folder import open_weights

    weights = open_weights(os.environ)
    chosen = [weights.item(name) for name in items] if items else list(weights.items.values())
    num_bad = count = 0
    with StageProgress({"hashed": len(chosen)}, quiet, "items", PATIENCE_SEC) as progress:
        found = [(item, weights.verify(item)) for item in progress.each("hashed", chosen)]
    for item, verdicts in found:
        if not items and all(verdict.got is None for verdict in verdicts):
            continue
        for verdict in verdicts:
            count += 1
            num_bad += verdict.is_wrong or verdict.got is None
            print(f"{item.name}/{verdict.path.name}: {_describe(verdict)}")
    print(f"{count} files in {weights.folder}, {num_bad} wrong or missing")
    if num_bad:
        raise typer.Exit(1)


@weights_app.command("tiny")
def tiny(
    folder: Annotated[Path, typer.Argument(help="Folder to write; MOSEG_WEIGHTS then names it.", metavar="DIR")],
    seed: Annotated[int, typer.Option("--seed", min=0, help="Another one gives other random numbers.")] = 0,
    only: Annotated[
        str | None,
        typer.Option(
            "--only",
            help="Only these items, separated by commas (default: what any preset or choice of a network reads).",
            metavar="NAMES",
            autocompletion=completion.complete_weights_list,
        ),
    ] = None,
) -> None:
    """Make tiny random checkpoints, to try presets without the real weights.

    Examples
    --------
    moseg weights tiny tiny-weights
    moseg weights tiny tiny-weights --only raft-large,pips
    """
    from moseg.workflows.weights.catalogue import CATALOGUE
    from moseg.workflows.weights.folder import Weights
    from moseg.workflows.weights.tiny.make_tiny import make_tiny

    names = [name.strip() for name in (only or "").split(",") if name.strip()]
    if only is not None and not names:
        raise InputError("no item named", where="--only", got=repr(only), expected="names separated by commas")
    names = names or _all_items()
    catalogue = Weights(folder, {item.name: item for item in CATALOGUE})
    made = make_tiny(folder, [catalogue.item(name) for name in dict.fromkeys(names)], seed)
    print(f"{len(made)} items in {folder}: {', '.join(item.name for item in made)}")
    print(f"use them: export MOSEG_WEIGHTS={folder.resolve()}")


def _all_items() -> list[str]:
    """Return the names of the weights items that a preset or a choice reads if no item is named; some come twice."""
    from moseg.schemas.configs import PipelineConfig
    from moseg.schemas.presets import LIGHT, PRESETS
    from moseg.workflows.stages.registry import all_choices

    sets = [*((preset, False) for preset in PRESETS), *((preset, True) for preset in LIGHT)]
    of_presets = [name for preset, is_light in sets for name in _items_of(preset, is_light)]
    default = PipelineConfig()
    backends = (backend for choice in all_choices() for backend in choice.backends)
    return of_presets + [each.network.item(default) for each in backends if each.network is not None]


def _items_of(preset: str | None, light: bool) -> tuple[str, ...]:
    """Return the names of the weights items that a preset reads; raises InputError if it has no such networks."""
    from moseg.schemas.configs import PipelineConfig
    from moseg.workflows.stages.needed_weights import needed_items

    if preset is None and not light:
        return ()
    values = choose_preset(**({} if preset is None else {"preset": preset}), light=light)
    return tuple(needed_items(PipelineConfig.model_validate(values)))


def _describe(verdict) -> str:
    if verdict.got is None:
        return "missing"
    if verdict.is_wrong:
        return f"WRONG, SHA-256 {verdict.got}, expected {verdict.expected}"
    return f"SHA-256 {verdict.got}" + ("" if verdict.expected else " (nothing says what it must be)")
