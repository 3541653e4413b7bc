"""Searches that advance together, so that what all of them need next is computed in one batch."""

from collections.abc import Callable, Generator, Sequence
from typing import NamedTuple, TypeVar

import numpy as np

T = TypeVar("T")


class Needed(NamedTuple):
    """Labelings int (N,) whose coding lengths and whose costs a search reads next."""

    codes: Sequence[np.ndarray] = ()
    costs: Sequence[np.ndarray] = ()


Search = Generator[Needed, None, T]
"""A search: it yields what it needs, may rely on it afterwards, and returns its result."""


def run_together(searches: Sequence[Search[T]], prepare: Callable[[Needed], None]) -> list[T]:
    """Return the results of searches, all of which advance by one step after each call of `prepare`.

    A step of one search needs few groups, which take less time together than one after another. The results do not
    depend on which searches advance together.
    """
    results: dict[int, T] = {}
    running = dict(enumerate(searches))
    while running:
        needed = []
        for index, search in list(running.items()):
            try:
                needed.append(next(search))
            except StopIteration as end:
                results[index] = end.value
                del running[index]
        if needed:
            prepare(
                Needed(
                    [each for step in needed for each in step.codes], [each for step in needed for each in step.costs]
                )
            )
    return [results[index] for index in range(len(searches))]
