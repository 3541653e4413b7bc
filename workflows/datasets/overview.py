"""Overview of the data sets: which are on disk, which are not, and how to get them."""

import os
from collections.abc import Mapping
from typing import NamedTuple

from moseg.schemas.errors import InputError
from moseg.schemas.spelling import unknown_name
from moseg.workflows.datasets.dataset import DatasetLayout, OptionalRoot
from moseg.workflows.datasets.registry import DATASETS
from moseg.workflows.datasets.selection import default_root, select_sequences


class DatasetRow(NamedTuple):
    """One data set at its default root.

    Attributes
    ----------
    name : str
    is_present : bool
        At least one sequence can be run.
    root : str or None
        Folder that was searched; None if none is known or needed.
    names, absent : tuple of str
        Sequences found, and those of the official list that were not found.
    ground_truth, tree, source : str
        What is annotated, the files expected below the root, and where to get them.
    problem : str
        Reason why it cannot be run; empty if it can.
    """

    name: str
    is_present: bool
    root: str | None
    names: tuple[str, ...]
    absent: tuple[str, ...]
    ground_truth: str
    tree: str
    source: str
    problem: str


def describe_datasets(env: Mapping[str, str]) -> tuple[DatasetRow, ...]:
    """Return a row for each data set, searched below ``$MOSEG_DATA`` of the environment `env`."""
    return tuple(_describe(layout, default_root(layout, env)) for layout in DATASETS.values())


def describe_dataset(name: str, root: str | None, env: Mapping[str, str]) -> DatasetRow:
    """Return the row of one data set at `root`, else below ``$MOSEG_DATA``; raise InputError for an unknown name."""
    if name not in DATASETS:
        raise unknown_name("data set", name, DATASETS)
    layout = DATASETS[name]
    return _describe(layout, os.path.abspath(root) if root else default_root(layout, env))


def _describe(layout: DatasetLayout, root: str | None) -> DatasetRow:
    root = root if layout.needs_root or isinstance(layout, OptionalRoot) else None
    names, absent, problem = (), layout.official or (), ""
    if layout.needs_root and root is None:
        problem = "$MOSEG_DATA is not set"
    elif layout.needs_root and not os.path.isdir(root):
        problem = f"no folder {root}"
    else:
        try:
            names, absent = select_sequences(layout, root, None, None)
        except InputError as error:
            problem = str(error)
    texts = (layout.ground_truth, layout.tree, layout.source)
    return DatasetRow(layout.name, not problem, root, names, absent, *texts, problem)
