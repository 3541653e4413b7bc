"""`moseg backends`."""

import os
from typing import Annotated

import typer

NUM_CORES = 4
"""Of a laptop."""
PROMPTED = ("motion-prompts",)
"""Sources of proposals whose sums are shown beside those of the presets' own."""


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
    from moseg.schemas.presets import LIGHT, PRESETS
    from moseg.workflows.cli.merits_table import list_sources, merits_table
    from moseg.workflows.cli.tables import console
    from moseg.workflows.config.pipeline_choices import PipelineChoices
    from moseg.workflows.stages.merits import list_merits, sum_costs
    from moseg.workflows.weights.folder import open_weights

    rows = list_merits(open_weights(os.environ).items)
    sources = list_sources(rows)
    console().print(merits_table(rows, sources))
    for number, source in enumerate(sources, start=1):
        print(f"    [{number}] {source}")
    print("Figures: as published, not measured here. CPU seconds: measured at 854x480 on one core; -: not measured.")
    print(f"Networks of the presets, a frame of 854x480 on one core, and on {NUM_CORES} cores that share the frames:")
    for name, is_light in (*((name, False) for name in PRESETS), *((name, True) for name in LIGHT)):
        for source in (None, *PROMPTED):
            settings = () if source is None else (("proposal_source", source),)
            config = PipelineChoices(preset=name, light=is_light, settings=settings).make_config()
            found = sum_costs(config, is_light)
            if not found.seconds and not found.unmeasured:
                continue
            words = f"--preset {name}{' --light' if is_light else ''}{f' --proposals {source}' if source else ''}"
            rest = f", and what was not measured: {', '.join(found.unmeasured)}" if found.unmeasured else ""
            print(f"    {words}: {found.seconds:.1f} s, on {NUM_CORES} cores {found.seconds / NUM_CORES:.1f} s{rest}")


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
