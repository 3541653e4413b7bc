"""Parts that a report cannot show: the reason once, then all parts to which it applies."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from enum import StrEnum
from typing import NamedTuple

from moseg.schemas.errors import MissingArtifactError
from moseg.schemas.recipes import split_ref

KEY_DIGITS = 10
"""Digits of a key that are shown: `moseg store show` takes them."""


class WhyAbsent(StrEnum):
    """Why artifacts of a run are not in the store."""

    GONE = "Not shown, because not in the store (without --keep-cues, collected since the run, or never computed)"
    NOT_YET = "Not computed yet"
    """Of a run that has not finished."""


class AbsentPart(NamedTuple):
    """A part of a page, and the artifacts that it lacks."""

    name: str
    artifacts: str


Missing = AbsentPart | str
"""What cannot be shown: a part that lacks artifacts, or a sentence."""


def name_absent(name: str, refs: Iterable[str]) -> AbsentPart:
    """Return a part that lacks these artifacts, counted by task."""
    counts = sorted(Counter(split_ref(ref)[0] for ref in refs).items())
    return AbsentPart(name, ", ".join(task if count == 1 else f"{count} {task}" for task, count in counts))


@contextmanager
def collect_missing(missing: list[Missing], name: str) -> Iterator[None]:
    """Add a part to `missing` where the block needs an artifact that is not stored; damage is raised."""
    try:
        yield
    except MissingArtifactError as error:
        stage, key = split_ref(str(error.parts[1]))
        missing.append(AbsentPart(name, f"{stage}/{key[:KEY_DIGITS]}"))


def format_missing(missing: Sequence[Missing], why: WhyAbsent) -> tuple[str, ...]:
    """Return one sentence for all parts that lack artifacts, then the other sentences."""
    parts = [f"{part.name} [{part.artifacts}]" for part in missing if isinstance(part, AbsentPart)]
    absent = (f"{why}: {'; '.join(parts)}.",) if parts else ()
    return (*absent, *(text for text in missing if isinstance(text, str)))
