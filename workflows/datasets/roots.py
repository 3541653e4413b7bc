"""Where a data set lies."""

import os
from collections.abc import Mapping

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.datasets.dataset import DatasetLayout

DATA_VARIABLE = "MOSEG_DATA"
"""Environment variable: folder of all data sets, each in a subfolder of its name."""


def default_root(layout: DatasetLayout, env: Mapping[str, str]) -> str | None:
    """``$MOSEG_DATA/<dataset>``; None where the variable is not set."""
    data = env.get(DATA_VARIABLE)
    return os.path.abspath(os.path.join(data, layout.name)) if data else None


def find_root(layout: DatasetLayout, root: str | None, env: Mapping[str, str]) -> str | None:
    """The root given, else the default one; None for what needs no files.

    Raises
    ------
    MissingInputError
        There is no such folder: says what to fetch from where and which files are expected.
    InputError
        A root for a data set that has no files.
    """
    if not layout.needs_root:
        if root is not None:
            raise InputError(f"data set {layout.name} has no files", got=f"root {root}", expected="no root")
        return None
    found = os.path.abspath(root) if root else default_root(layout, env)
    if found is None or not os.path.isdir(found):
        raise MissingInputError(
            f"data set {layout.name} is not there",
            where=found,
            got=None if found else f"no root and no ${DATA_VARIABLE}",
            expected=f"a root (--root or ${DATA_VARIABLE}/{layout.name}) with {layout.tree}. Get it: {layout.source}",
        )
    return found
