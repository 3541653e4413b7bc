"""`moseg datasets` and `moseg backends`."""

import os


def datasets() -> None:
    """Data sets: which are there, which are missing, and how to get them."""
    from workflows.datasets import describe_datasets

    for row in describe_datasets(os.environ):
        found = f"{len(row.names)} sequences" if row.is_present else f"not here: {row.problem}"
        print(f"{row.name}: {found}")
        print(f"    ground truth  {row.ground_truth}")
        print(f"    files         {row.tree}")
        print(f"    from          {row.source}")
        if row.is_present and row.absent:
            print(f"    absent        {', '.join(row.absent)}")
    print("A data set is looked for at --root, else at $MOSEG_DATA/<name>.")


def backends() -> None:
    """Methods of every stage, with the option that chooses each; none of them needs weights."""
    from rich.table import Table

    from workflows.cli.tables import console

    table = Table(title="backends (none needs weights; all are present)")
    for column in ("stage", "method", "chosen by", "code"):
        table.add_column(column)
    for row in BACKENDS:
        table.add_row(*row)
    console().print(table)


BACKENDS = (
    ("flow", "DIS, both directions", "--flow dis", "OpenCV, Apache-2.0"),
    ("flow", "exact (synthetic)", "--flow groundtruth", "this project, MIT"),
    ("proposals", "motion saliency", "--proposals saliency", "this project, MIT"),
    ("proposals", "annotated objects (an oracle)", "--proposals groundtruth", "this project, MIT"),
    ("proposals", "your own masks", "--proposals folder:PATH", "this project, MIT"),
    ("tracks", "pyramidal Lucas-Kanade", "--tracks lucas-kanade", "OpenCV, Apache-2.0"),
    ("tracks", "exact (synthetic)", "--tracks groundtruth", "this project, MIT"),
    ("depth", "none", "--depth none", "this project, MIT"),
    ("depth", "exact (synthetic)", "--depth groundtruth", "this project, MIT"),
    ("depth", "your own maps", "--depth folder:PATH", "this project, MIT"),
)
