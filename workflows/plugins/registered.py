"""What plug-ins have registered in this process, and how worker processes get the same."""

from typing import Any, NamedTuple


class Registered(NamedTuple):
    """One declaration of a plug-in.

    Attributes
    ----------
    declared : object
        Such as `moseg.register` takes.
    package : str
        Top-level packages and modules that it comes from, separated by blanks.
    code : str
        Fingerprint of their code.
    is_installed : bool
        Whether an entry point names it, so that other processes find it by themselves.
    """

    declared: Any
    package: str
    code: str
    is_installed: bool

    @property
    def name(self) -> tuple[str, ...]:
        """Package, kind and name of what is declared."""
        task = getattr(self.declared, "task", None)
        names = (self.declared.name,) if task is None else (task.name, task.method)
        return self.package, type(self.declared).__name__, *names


class PluginSet:
    """The plug-ins of a process, to be sent to others; two sets are equal if they hold the same code.

    Attributes
    ----------
    codes : dict of str to str
        Fingerprint of every package.
    declared : tuple of Registered
        Those that no entry point names.
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
    """Return what is registered in this process."""
    return PluginSet(tuple(entries))
