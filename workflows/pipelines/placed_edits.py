"""Edits with the places where a user wrote them, checked against the objects that a sequence has."""

from collections.abc import Sequence
from typing import NamedTuple

from moseg.schemas.corrections import Edit
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.stages.corrected_objects import object_names


class PlacedEdits(NamedTuple):
    """Edits in the order in which they apply, and where each was written, for errors: ``fixes.yaml: edit 2 (drop)``."""

    edits: tuple[Edit, ...] = ()
    places: Sequence[str] = ()


NO_EDITS = PlacedEdits()


def check_edits(session: Session, graph: SequenceGraph, given: PlacedEdits) -> None:
    """Compute the objects of a sequence if that is needed, and check that the edits can be applied to them.

    To be called by the `build` of `Session.compute`: before the work that only a right edit is worth.

    Raises
    ------
    InputError
        An edit names an object or a frame that is not there, or a number that is in use.
    """
    if not given.edits:
        return
    from moseg.tasks.corrections.replay import replay_steps
    from moseg.tasks.corrections.steps import steps_of

    linking = graph.objects.linking()
    (attributes,) = session.settle(dict(graph.recipes), [linking], graph.leaves.frames)
    # Which motions there are does not matter here.
    motions = dict.fromkeys(object_names(attributes)[1:].tolist(), 0)
    replay_steps(steps_of(given.edits), motions, len(graph.leaves.frames), given.places)
