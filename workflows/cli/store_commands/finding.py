"""From what a user writes to a store that exists and an artifact in it."""

import re
from typing import Annotated

import typer

from moseg.schemas.errors import InputError

KeyArgument = Annotated[str, typer.Argument(help="<task>/<key>, or the first letters of a key.")]

_FULL_KEY = re.compile(r"[0-9a-f]{64}")
_TASK = re.compile(r"[a-z][a-z0-9_]{0,63}")


def open_existing(url: str):
    """Return the store at a place where one must be."""
    from moseg.store import open_store

    return open_store(url, create=False)


def find_artifact(store, key: str) -> str:
    """Return the one artifact whose reference or key begins with `key`.

    A whole reference or key is looked up; the start of one asks for a listing, of its task where that is named.

    Raises
    ------
    InputError
        No artifact begins so, or several do.
    """
    from moseg.workflows.stages.registry import artifact_names

    task, _, start = key.rpartition("/")
    found: list[str] | set[str] = set()
    is_whole = _FULL_KEY.fullmatch(start) is not None
    if is_whole:
        tasks = [task] if task else artifact_names()
        found = store.present(f"{each}/{start}" for each in tasks if _TASK.fullmatch(each))
    # What ingest and weights leave is in no list: their whole keys, without a name, take a listing.
    if not found and not (is_whole and task):
        listed = store.refs(task) if _TASK.fullmatch(task) else store.refs()
        found = [ref for ref in listed if ref.startswith(key) or ref.partition("/")[2].startswith(key)]
    if not found:
        raise InputError("no such artifact", where=store.url, got=key, expected="<task>/<key> or its start")
    if len(found) > 1:
        raise InputError("ambiguous key", got=key, expected=f"more letters: {len(found)} artifacts begin so")
    (ref,) = found
    return ref


def find_pins(store, run: str) -> list[str]:
    """Return the names of the pins of a run, which is given by its pin or, as to `moseg status`, by its log.

    Raises
    ------
    InputError
        There is no such run, or gc keeps nothing for it.
    """
    pinned = store.pinned()
    if run in pinned:
        return [run]
    from moseg.workflows.runlog.status import find_run, read_status

    names = {pin.run for pin in pinned.values()} - {""}
    # the log of a run whose results are pinned may be gone, or at the store from which they were copied
    begun = [name for name in names if run and name.startswith(run)]
    logged = begun[0] if len(begun) == 1 and begun[0] not in store.logs() else find_run(store, run)
    closed = read_status(store, logged).pins if logged in store.logs() else ()
    found = [name for name in pinned if name in (logged, *closed) or pinned[name].run == logged]
    if not found:
        expected = "one of `moseg store ls --runs`"
        raise InputError("a run of which nothing is kept", where=store.url, got=logged, expected=expected)
    return found
