"""Loading of the plug-ins of installed packages, once in each process."""

from functools import cache
from importlib.metadata import EntryPoint, entry_points
from threading import RLock

from moseg.schemas.errors import InputError, MosegError
from moseg.workflows.plugins.code import code_of_plugin
from moseg.workflows.plugins.registered import PluginSet, Registered, entries

GROUP = "moseg.plugins"


_lock = RLock()
_under_way: list[str] = []


def load_plugins() -> None:
    """Register the objects, or tuples and lists of them, that the entry points of the group ``moseg.plugins`` name.

    An object that a script has registered before is left as it is. While plug-ins are imported, which may ask for the
    names of methods, a further call of the same thread does nothing; other threads wait.

    Raises
    ------
    InputError
        A plug-in cannot be imported or registered; the message names its entry point and its package.
    """
    with _lock:
        if not _under_way:
            _load_once()


@cache
def _load_once() -> None:
    found = entry_points(group=GROUP)
    if not found:
        return
    _under_way.append(GROUP)
    try:
        for entry in sorted(found, key=lambda entry: entry.name):
            _load(entry)
    finally:
        _under_way.clear()


def _load(entry: EntryPoint) -> None:
    from moseg.workflows.plugins.registration import add_entry, check_kind

    name = entry.dist.name if entry.dist else entry.module
    expected = f"a plug-in that can; without it: pip uninstall {name}"
    try:
        declared = entry.load()
        for each in declared if type(declared) in (tuple, list) else (declared,):
            check_kind(each, entry.module)
            if all(known.declared is not each for known in entries):
                add_entry(Registered(each, *code_of_plugin(each, entry.module), is_installed=True))
    except MosegError as error:
        raise InputError("plug-in cannot be registered", where=entry.value, got=error, expected=expected) from error
    except Exception as error:
        got = f"{type(error).__name__}: {error}"
        raise InputError("plug-in cannot be imported", where=entry.value, got=got, expected=expected) from error


def match_plugins(wanted: PluginSet, where: str) -> None:
    """Register the plug-ins of another process in this one.

    Raises
    ------
    InputError
        A plug-in that the other process has installed is missing here, or has other code.
    """
    load_plugins()
    known = {entry.name for entry in entries}
    for entry in wanted.declared:
        if entry.name not in known:
            from moseg.workflows.plugins.registration import add_entry

            add_entry(entry)
    codes = {entry.package: entry.code for entry in entries}
    for package, code in wanted.codes.items():
        if codes.get(package) != code:
            got = f"code {codes[package]}" if package in codes else "not installed"
            expected = f"code {code}, as in the client"
            raise InputError(f"another version of plug-in {package}", where=where, got=got, expected=expected)
