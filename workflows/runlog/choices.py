"""Choices between sources of proposals, in one line."""

from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress

from pydantic import TypeAdapter, ValidationError

from moseg.schemas.events import SubjectEvent
from moseg.schemas.stretch_choice import StretchChoice

_CHOICES = TypeAdapter(tuple[StretchChoice, ...])

NUM_TOLD = 4
"""Stretches that are described in full; counts stand for more."""


def read_choices(event: SubjectEvent) -> dict[str, tuple[StretchChoice, ...]]:
    """Return the choices of a run's sequences, by name; none of those that another version wrote in another form."""
    found = {}
    for sequence in event.sequences:
        with suppress(ValidationError):
            chosen = _CHOICES.validate_python(sequence.leaves.get("choices") or ())
            if chosen:
                found[str(sequence.leaves.get("name"))] = chosen
    return found


def describe_choices(choices: Mapping[str, Sequence[StretchChoice]]) -> str:
    """Return a line about the choices of some sequences, by name: each in full where they are few, else counts."""
    stretches = [(name, choice) for name, chosen in choices.items() for choice in chosen]
    if len(stretches) <= NUM_TOLD:
        return "; ".join(f"{name}: {choice}" if len(choices) > 1 else str(choice) for name, choice in stretches)
    counts = Counter(choice.proposals for _, choice in stretches)
    told = " and ".join(f"{source} for {count} of {len(stretches)} stretches" for source, count in counts.most_common())
    if "tracks" in counts and len(counts) > 1:
        names = dict.fromkeys(name for name, choice in stretches if choice.proposals == "tracks")
        shown = ", ".join(list(names)[:NUM_TOLD])
        told += f" (tracks in {shown}{' and others' if len(names) > NUM_TOLD else ''})"
    return told
