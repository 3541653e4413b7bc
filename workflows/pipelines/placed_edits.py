"""Edits with the places where a user wrote them, checked against the objects that a sequence has."""

from collections.abc import Sequence
from typing import NamedTuple

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.corrections import Edit, Growing, Point, Stroke, kind_of
from moseg.schemas.errors import InputError
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.corrected_objects import object_names
from moseg.workflows.stages.registry import find_task
from moseg.workflows.weights.reading import require_network_packages


class PlacedEdits(NamedTuple):
    """Edits in the order in which they apply, and where each was written, for errors: ``fixes.yaml: edit 2 (drop)``."""

    edits: tuple[Edit, ...] = ()
    places: Sequence[str] = ()


NO_EDITS = PlacedEdits()
WITH_PIXELS = ("paint", "erase", "add")
"""Kinds of edits that draw in a frame."""


def with_edits(
    session: Session, source: SequenceSource, leaves: SequenceLeaves, config: PipelineConfig, given: PlacedEdits
) -> SequenceLeaves:
    """Return the leaves of a sequence with edits, and with what these need: the video's size, weights of SAM 2.1.

    Raises
    ------
    InputError
        Strokes or points of a frame that is not there, a point of an object or all strokes outside the frame, or the
        weights or the libraries of the network are missing.
    """
    # Of leaves that are held, so that a video is not opened for every edit.
    size, by_network = leaves.frame_size or source.frames.describe().size, False
    for index, edit in enumerate(given.edits):
        kind = kind_of(edit)
        if kind not in WITH_PIXELS:
            continue
        value, where = getattr(edit, kind), given.places[index] if given.places else f"edit {index + 1} ({kind})"
        if value.frame >= len(leaves.frames):
            raise InputError("no such frame", where=where, got=value.frame, expected=f"0 to {len(leaves.frames) - 1}")
        if isinstance(value, Growing):
            by_network = by_network or value.by == "sam2"
            _check_points((*value.points, *value.not_points), size, where)
        else:
            _check_strokes(value.strokes, size, where)
    if by_network:
        require_network_packages()
        network = find_task("grown_object", "sam2").network
        named = session.name_weights({network.item(config): network.architecture})
        leaves = leaves._replace(weights=leaves.weights | named)
    return leaves._replace(edits=given.edits, frame_size=size)


def _check_points(points: Sequence[Point], size: tuple[int, int], where: str) -> None:
    height, width = size
    for x, y in points:
        if not (-0.5 <= x <= width - 0.5 and -0.5 <= y <= height - 0.5):
            expected = f"x from 0 to {width - 1}, y from 0 to {height - 1}"
            raise InputError("a point outside the frame", where=where, got=f"{x:g}, {y:g}", expected=expected)


def _check_strokes(strokes: Sequence[Stroke], size: tuple[int, int], where: str) -> None:
    """Raise InputError if the boxes of all strokes lie beside the frame."""
    height, width = size
    for stroke in strokes:
        (left, right), (top, bottom) = ((min(values), max(values)) for values in zip(*stroke.points, strict=True))
        reach = stroke.radius + 0.5
        if left - reach < width and right + reach > 0 and top - reach < height and bottom + reach > 0:
            return
    got = ", ".join(f"{value:g}" for value in strokes[0].points[0])
    raise InputError("strokes outside the frame", where=where, got=got, expected=f"a part within {width}x{height} px")


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
