"""A decorator for methods whose result is computed once for each set of arguments."""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

Method = TypeVar("Method", bound=Callable)


def cached_method(method: Method) -> Method:
    """Return the method with a cache, kept on its object, of the results by arguments.

    A dozen nodes read a frame's flow; writing its recipe for each of them took most of the time of a plan.
    """
    name = method.__name__

    @wraps(method)
    def cached(self, *arguments):
        written = self.__dict__.setdefault("_written", {})
        entry = (name, *arguments)
        if entry not in written:
            written[entry] = method(self, *arguments)
        return written[entry]

    return cached
