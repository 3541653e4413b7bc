"""`moseg backends`."""

import os


def backends() -> None:
    """List the methods of every stage, their options, and the weights: licence, size, whether they are here.

    Examples
    --------
    moseg backends
    """
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
        licence = row.item.licence + (" (opt-in)" if row.item.is_non_commercial else "")
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
