"""Calls that wait for each other, and what runs them."""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, Protocol


class Call(NamedTuple):
    """A function, its arguments, and the names of the calls that must be done before it.

    Names begin with the stage and a hyphen. A call that runs a network has `needs_gpu`: where there are GPUs, no other
    such call shares its own.
    """

    name: str
    function: Callable[..., Any]
    arguments: tuple
    after: tuple[str, ...] = ()
    needs_gpu: bool = False


class Runner(Protocol):
    """Runs calls in an order that their dependencies allow."""

    def run(self, calls: Iterable[Call], on_done: Callable[[str, Any], None]) -> None:
        """Run all `calls` (each listed after those it waits for); tell `on_done` each name and result; raise the first
        error.

        Calls are drawn as there is room for them: of any number, only so many are held as a window takes.
        """

    def has_gpu(self) -> bool:
        """Whether calls that run a network run it on a GPU; raises InputError where one was asked for in vain."""

    def num_workers(self) -> int:
        """How many calls run at the same time."""
