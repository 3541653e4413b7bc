"""The root of a data set, and the choice of its sequences."""

import os
from collections.abc import Mapping
from typing import NamedTuple

from moseg.schemas.errors import InputError, MissingInputError
from moseg.schemas.spelling import unknown_name
from moseg.workflows.datasets.dataset import DatasetLayout, OptionalRoot
from moseg.workflows.sources.files import read_bytes

DATA_VARIABLE = "MOSEG_DATA"
"""Environment variable: folder of all data sets, each in a subfolder of its name."""


def default_root(layout: DatasetLayout, env: Mapping[str, str]) -> str | None:
    """Return ``$MOSEG_DATA/<dataset>``; None if the variable is not set."""
    data = env.get(DATA_VARIABLE)
    return os.path.abspath(os.path.join(data, layout.name)) if data else None


def find_root(layout: DatasetLayout, root: str | None, env: Mapping[str, str]) -> str | None:
    """Return the root given, else the default one; None for a data set without files.

    A default root that is optional need not exist.

    Raises
    ------
    MissingInputError
        There is no such folder; the message says what to download and which files are expected.
    InputError
        A root for a data set that has no files.
    """
    if isinstance(layout, OptionalRoot) and root is None:
        return default_root(layout, env)
    if not layout.needs_root and not isinstance(layout, OptionalRoot):
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


class Selection(NamedTuple):
    """Sequences to run, and requested ones that are not on disk."""

    names: tuple[str, ...]
    absent: tuple[str, ...]


def select_sequences(
    layout: DatasetLayout, root: str | None, sequences: tuple[str, ...] | None, list_file: str | None
) -> Selection:
    """Choose the `sequences` named, else those listed, else all that are on disk.

    A sequence outside the list may be named. Letter case does not matter, as it differs between releases.

    Raises
    ------
    InputError
        A name that is neither on disk nor listed.
    MissingInputError
        No requested sequence is on disk, or the data set needs a list file and has none.
    """
    on_disk = layout.on_disk(root)
    if sequences is None or list_file:
        listed = _listed(layout, root, list_file)
    else:
        listed = layout.official
    has_all = sequences is None and listed is None
    absent = list(layout.missing(root)) if has_all and isinstance(layout, OptionalRoot) else []
    wanted = sequences if sequences is not None else listed if listed is not None else on_disk
    folded = {name.casefold(): name for name in on_disk} | {name: name for name in on_disk}
    names = []
    for name in dict.fromkeys(wanted):
        found = folded.get(name) or folded.get(name.casefold())
        if found is None and name not in (listed or ()) and sequences is not None:
            raise unknown_name(f"sequence of {layout.name}", name, {*on_disk, *(listed or ())})
        if found is None:
            absent.append(name)
        elif found not in names:
            names.append(found)
    if not names:
        raise MissingInputError(
            f"no sequence of {layout.name} is there",
            where=root,
            got=f"{len(absent)} absent: {', '.join(absent)}" if absent else None,
            expected=f"{layout.tree}. Get it: {layout.source}",
        )
    return Selection(tuple(names), tuple(absent))


def read_list(path: str) -> tuple[str, ...]:
    """Return the names of a list file, one per line; blank lines and text after ``#`` are ignored."""
    try:
        text = read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError("list of sequences is not text", where=path, expected="UTF-8, one name per line") from error
    names = [line.split("#")[0].strip() for line in text.splitlines()]
    names = tuple(dict.fromkeys(name for name in names if name))
    if not names:
        raise InputError("list of sequences is empty", where=path, expected="one name per line")
    return names


def _listed(layout: DatasetLayout, root: str | None, list_file: str | None) -> tuple[str, ...] | None:
    """Return the list to use: the user's, the official one, or the one below the root."""
    if list_file:
        return read_list(list_file)
    if layout.official is not None or layout.list_name is None:
        return layout.official
    path = os.path.join(root, layout.list_name)
    if not os.path.isfile(path):
        raise MissingInputError(
            f"data set {layout.name} has no list of sequences",
            expected=f"{path} or a list file given, one sequence per line. Get it: {layout.source}",
        )
    return read_list(path)
