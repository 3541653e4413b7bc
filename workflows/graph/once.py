"""Writing each node once, however many others read it."""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

Method = TypeVar("Method", bound=Callable)


def once(method: Method) -> Method:
    """The method, remembering on its object what it gave for the same arguments.

    A frame's flow is read by a dozen nodes; to write its recipe for each of them took most of the time of a plan.
    """
    name = method.__name__

    @wraps(method)
    def remembered(self, *arguments):
        written = self.__dict__.setdefault("_written", {})
        entry = (name, *arguments)
        if entry not in written:
            written[entry] = method(self, *arguments)
        return written[entry]

    return remembered
