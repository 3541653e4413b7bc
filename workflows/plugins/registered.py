"""Declarations that plug-ins have registered in this process, and the set of them that workers receive."""

from typing import Any, NamedTuple


class Registered(NamedTuple):
    """Declaration of a plug-in.

    Attributes
    ----------
    declared : object
        Object that `moseg.register` accepts.
    package : str
        Top-level packages and modules that define it, separated by blanks.
    code : str
        Fingerprint of their code.
    is_installed : bool
        Whether an entry point names it, so that other processes find it on their own.
    """

    declared: Any
    package: str
    code: str
    is_installed: bool

    @property
    def name(self) -> tuple[str, ...]:
        """Package, kind and name of the declared object."""
        task = getattr(self.declared, "task", None)
        names = (self.declared.name,) if task is None else (task.name, task.method)
        return self.package, type(self.declared).__name__, *names


class PluginSet:
    """Plug-ins of a process, to be sent to others; two sets are equal if they hold the same code.

    Attributes
    ----------
    codes : dict of str to str
        Fingerprint of every package.
    declared : tuple of Registered
        Declarations that no entry point names.
    """

    def __init__(self, entries: tuple[Registered, ...]):
        self.codes = {entry.package: entry.code for entry in entries}
        self.declared = tuple(entry for entry in entries if not entry.is_installed)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PluginSet):
            return NotImplemented
        names, others = ({entry.name for entry in each.declared} for each in (self, other))
        return (self.codes, names) == (other.codes, others)

    __hash__ = None


entries: list[Registered] = []


def plugins_of_process() -> PluginSet:
    """Return the plug-ins that are registered in this process."""
    return PluginSet(tuple(entries))
