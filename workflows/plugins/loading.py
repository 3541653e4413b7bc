"""Loading of the plug-ins of installed packages, once in each process."""

from functools import cache
from importlib.metadata import entry_points

from moseg.schemas.errors import InputError, MosegError
from moseg.workflows.plugins.code import code_of_plugin
from moseg.workflows.plugins.registered import PluginSet, Registered, entries

GROUP = "moseg.plugins"


@cache
def load_plugins() -> None:
    """Register the objects, or tuples and lists of them, that the entry points of the group ``moseg.plugins`` name.

    Raises
    ------
    InputError
        A plug-in cannot be imported or registered; the message names its entry point.
    """
    found = entry_points(group=GROUP)
    if not found:
        return
    from moseg.workflows.plugins.registration import add_entry, check_kind

    for entry in sorted(found, key=lambda entry: entry.name):
        try:
            declared = entry.load()
            for each in declared if type(declared) in (tuple, list) else (declared,):
                check_kind(each, entry.module)
                add_entry(Registered(each, *code_of_plugin(each, entry.module), is_installed=True))
        except MosegError as error:
            raise InputError("plug-in cannot be registered", where=entry.value, got=error) from error
        except Exception as error:
            got = f"{type(error).__name__}: {error}"
            raise InputError("plug-in cannot be imported", where=entry.value, got=got) from error


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
