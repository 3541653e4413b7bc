"""`moseg datasets` and `moseg backends`."""

import os

from rich.table import Table


def datasets() -> None:
    """Data sets: which are there, which are missing, and how to get them."""
    from workflows.cli.tables import console
    from workflows.datasets import describe_datasets

    table = Table(title="data sets (--root, else $MOSEG_DATA/<name>)")
    for column in ("name", "present", "sequences", "ground truth", "files below the root", "where to get it"):
        table.add_column(column)
    for row in describe_datasets(os.environ):
        present = "yes" if row.is_present else f"no: {row.problem}"
        count = f"{len(row.names)} (absent: {', '.join(row.absent)})" if row.absent else str(len(row.names))
        table.add_row(row.name, present, count, row.ground_truth, row.tree, row.source)
        table.add_section()
    console().print(table)


def backends() -> None:
    """Methods of every stage, with the option that chooses each; none of them needs weights."""
    from workflows.cli.tables import console

    table = Table(title="backends (no weights needed, all present)")
    for column in ("stage", "method", "licence", "chosen by"):
        table.add_column(column)
    for row in BACKENDS:
        table.add_row(*row)
    console().print(table)


BACKENDS = (
    ("flow", "dis", "Apache-2.0 (OpenCV)", "--flow dis"),
    ("flow", "groundtruth", "-", "--flow groundtruth"),
    ("proposals", "saliency", "MIT (this project)", "--proposals saliency"),
    ("proposals", "groundtruth", "-", "--proposals groundtruth"),
    ("proposals", "folder", "-", "--proposals folder:PATH"),
    ("tracks", "lucas-kanade", "Apache-2.0 (OpenCV)", "--tracks lucas-kanade"),
    ("tracks", "groundtruth", "-", "--tracks groundtruth"),
    ("depth", "none", "-", "--depth none"),
    ("depth", "groundtruth", "-", "--depth groundtruth"),
    ("depth", "folder", "-", "--depth folder:PATH"),
)
