"""Attributes of the artifacts that decide what a graph is, computed before the rest of it is written."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from moseg.schemas.recipes import Recipe
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceLeaves


class Writer(Protocol):
    """Writer of such recipes of a sequence."""

    @property
    def recipes(self) -> dict[str, Recipe]:
        """Recipes written so far, by reference."""

    def refs(self) -> tuple[str, ...]:
        """Return the references of what is settled."""


def settle_attributes(
    session: Session, leaves: Sequence[SequenceLeaves], writers: Sequence[Writer]
) -> dict[str, Mapping]:
    """Return the attributes of all that the writers of some sequences settle, by reference."""
    sinks = [ref for writer in writers for ref in writer.refs()]
    if not sinks:
        return {}
    recipes = {ref: recipe for writer in writers for ref, recipe in writer.recipes.items()}
    held = {ref for each in leaves for ref in each.refs()}
    return dict(zip(sinks, session.settle(recipes, sinks, held), strict=True))
