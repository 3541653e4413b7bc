"""A call: a function with its arguments, and the calls that it waits for."""

from collections.abc import Callable
from typing import Any, NamedTuple


class Call(NamedTuple):
    """A function, its arguments, and the names of the calls that must be done before it.

    Names begin with the stage and a hyphen. A call that runs a network has `needs_gpu`: on a GPU, no other such call
    runs at the same time.
    """

    name: str
    function: Callable[..., Any]
    arguments: tuple
    after: tuple[str, ...] = ()
    needs_gpu: bool = False
