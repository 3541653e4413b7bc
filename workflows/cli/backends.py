"""`moseg backends`."""

import os
from typing import Annotated

import typer

NUM_CORES = 4
"""Of a laptop."""


def backends(
    why: Annotated[
        bool,
        typer.Option("--why", help="Show what each choice gives by public figures, what it costs, and its licence."),
    ] = False,
) -> None:
    """List the methods of every stage, their options, and the weights: licence, size, whether they are here.

    Examples
    --------
    moseg backends
    moseg backends --why
    """
    if why:
        _print_merits()
    else:
        _print_methods()


def _print_merits() -> None:
    """Print what each choice gives, costs and allows, and the seconds a frame of the presets."""
    from rich.table import Table

    from moseg.schemas.configs import PipelineConfig
    from moseg.schemas.presets import LIGHT, PRESETS
    from moseg.workflows.cli.tables import console
    from moseg.workflows.config.pipeline_choices import choose_preset
    from moseg.workflows.stages.merits import list_merits, sum_costs
    from moseg.workflows.weights.folder import open_weights

    table = Table(title="what each choice gives and costs")
    for column in ("stage", "chosen by", "weights", "gives", "source", "CPU seconds", "licence"):
        table.add_column(column, overflow="fold")
    for row in list_merits(open_weights(os.environ).items):
        text, source = row.figure or ("-", "-")
        seconds = "-" if row.seconds is None else f"{row.seconds:.2g} a {row.frames}"
        table.add_row(row.choice, row.option, row.weights or "-", text, source, seconds, row.licence)
    console().print(table)
    print("Gives: as published, not measured here. CPU seconds: measured at 854x480 on one core; -: not measured.")
    print("Networks of the presets, a frame of a video of 854x480:")
    for name, is_light in (*((name, False) for name in PRESETS), *((name, True) for name in LIGHT)):
        found = sum_costs(PipelineConfig.model_validate(choose_preset(name, light=is_light)), is_light)
        if not found.seconds and not found.unmeasured:
            continue
        option = f"--preset {name}{' --light' if is_light else ''}"
        rest = f", and what was not measured: {', '.join(found.unmeasured)}" if found.unmeasured else ""
        shared = f"{found.seconds / NUM_CORES:.1f} s on {NUM_CORES} cores that share the frames evenly"
        print(f"    {option}: {found.seconds:.1f} s on one core, {shared}{rest}")


def _print_methods() -> None:
    from rich.table import Table

    from moseg.workflows.cli.tables import console
    from moseg.workflows.stages.needed_weights import parameters_of
    from moseg.workflows.stages.registry import all_choices
    from moseg.workflows.weights.folder import open_weights
    from moseg.workflows.weights.overview import weights_rows
    from moseg.workflows.weights.progress import describe_size

    weights = open_weights(os.environ)
    methods = Table(title="backends")
    for column in ("stage", "method", "chosen by", "code", "weights"):
        methods.add_column(column)
    for choice in all_choices():
        for backend in choice.backends:
            weights_item = "" if backend.network is None else backend.network.default
            methods.add_row(choice.name, backend.what, choice.option_of(backend), backend.code, weights_item)
    items = Table(title="weights")
    for column in ("weights", "named by --set", "licence", "size", "here", "fixed by"):
        items.add_column(column)
    rows = weights_rows(weights, parameters_of)
    for row in rows:
        licence = row.item.licence + (" (opt-in)" if row.item.consent else "")
        size, here = describe_size(row.size), "yes" if row.is_present else "no"
        parameters = ", ".join(f"{parameter}=…" for parameter in row.parameters)
        items.add_row(row.item.name, parameters, licence, size, here, row.pin)
    out = console()
    out.print(methods)
    out.print(items)
    print(f"Weights lie in {weights.folder} ($MOSEG_WEIGHTS); a run fetches what it needs and does not find there.")
    print("Fixed by: a published SHA-256; a revision, whose record gives it; or what the first download gave.")
    commands = [row.command for row in rows if row.command]
    if commands:
        print("To get beforehand what is not here:")
        for command in commands:
            print(f"    {command}")
