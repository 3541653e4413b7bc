"""Layers of the ground truth, and of where a variant differs from it."""

import numpy as np

from moseg.schemas.configs import Variant
from moseg.workflows.exports.draw_errors import ERROR_COLOURS, sort_errors
from moseg.workflows.exports.draw_regions import HATCH, RegionStyle, draw_regions
from moseg.workflows.exports.draw_tracks import TAIL_FRAMES, DrawnPoints, draw_tracks
from moseg.workflows.reports.encode_picture import encode_transparent
from moseg.workflows.reports.object_layers import POINT_RADIUS, STATIC_POINT
from moseg.workflows.reports.picture_content import Layer, LayerKind, LegendEntry, Picture
from moseg.workflows.reports.planned_layer import PlannedLayer
from moseg.workflows.reports.sequence_view import SequenceView, as_hex
from moseg.workflows.results.shown_frames import annotated_frames, label_points, read_labelled_points
from moseg.workflows.sources.resize import resize_labels

TRUTH_COLOUR = (255, 255, 255)
"""RGB, of no identity: what is true and what was found share no numbers."""
_TRUTH = RegionStyle(0.2)
_ERRORS = RegionStyle(0.7, line=0)
_ERROR_MEANINGS = {
    "true positive": "moves, and was found",
    "false positive": "found, but does not move",
    "false negative": "moves, but was not found",
}


def plan_truth(view: SequenceView) -> PlannedLayer | None:
    """What truly moves; None where nobody says."""
    if view.graph.leaves.annotation is not None:
        return PlannedLayer("ground truth", (view.graph.leaves.annotation,), lambda: _make_truth(view))
    if view.graph.leaves.labelled_points is not None:
        return PlannedLayer("ground truth", (view.graph.leaves.labelled_points,), lambda: _make_true_points(view))
    return None


def plan_errors(view: SequenceView, variant: Variant) -> PlannedLayer | None:
    """Where a variant is right and where it is wrong; None where nobody can say."""
    name, labels = f"errors ({variant})", view.label_refs(variant, view.frames)
    annotation, labelled_points = view.graph.leaves.annotation, view.graph.leaves.labelled_points
    if annotation is not None:
        return PlannedLayer(name, (annotation, *labels), lambda: _make_errors(view, variant, name))
    if labelled_points is not None:
        return PlannedLayer(name, (labelled_points, *labels), lambda: _make_point_errors(view, variant, name))
    return None


def _make_truth(view: SequenceView) -> Layer:
    void = view.graph.leaves.void
    colours = np.tile(np.array(TRUTH_COLOUR, np.uint8), (2**16, 1))

    def draw(frame: int) -> Picture | None:
        truth = _read_truth(view, frame)
        if truth is None:
            return None
        hatched = np.zeros(truth.shape, bool) if void is None else truth == void
        return encode_transparent(draw_regions(np.where(hatched, 0, truth), colours, view.shape, _TRUTH, hatched))

    legend = (LegendEntry(as_hex(TRUTH_COLOUR), "moves"),)
    if void is not None:
        legend += (LegendEntry(as_hex(HATCH), "striped: counts for neither side"),)
    description = "What truly moves, each object with a border of its own."
    return Layer("ground truth", LayerKind.OVER, tuple(map(draw, view.frames)), legend=legend, description=description)


def _make_errors(view: SequenceView, variant: Variant, name: str) -> Layer:
    void = view.graph.leaves.void
    colours = np.array([(0, 0, 0), *ERROR_COLOURS.values()], np.uint8)

    def draw(frame: int) -> Picture | None:
        truth = _read_truth(view, frame)
        if truth is None:
            return None
        kinds = sort_errors(resize_labels(view.labels(variant, frame), truth.shape), truth)
        regions = np.zeros(truth.shape, np.uint16)
        for number, kind in enumerate(ERROR_COLOURS, start=1):
            regions[kinds[kind]] = number
        if void is not None:
            regions[truth == void] = 0
        return encode_transparent(draw_regions(regions, colours, view.shape, _ERRORS))

    description = "All moving objects taken as one, compared with the ground truth pixel by pixel."
    pictures = tuple(map(draw, view.frames))
    return Layer(name, LayerKind.OVER, pictures, _list_errors(), description=description, is_beside=True)


def _make_true_points(view: SequenceView) -> Layer:
    (points, visible, labels), size = read_labelled_points(view.store, view.graph.leaves.labelled_points)
    order = np.argsort(labels > 0, kind="stable")
    colours = np.where((labels > 0)[:, None], np.array(TRUTH_COLOUR), np.array(STATIC_POINT) // 2).astype(np.uint8)

    def draw(frame: int) -> Picture:
        recent = slice(max(frame - TAIL_FRAMES, 0), frame + 1)
        drawn = DrawnPoints(points[order, recent], visible[order, recent], colours[order], size)
        return encode_transparent(draw_tracks(drawn, view.shape, POINT_RADIUS))

    legend = (
        LegendEntry(as_hex(TRUTH_COLOUR), "moves"),
        LegendEntry(as_hex(np.array(STATIC_POINT) // 2), "stands still"),
    )
    description = f"Labelled points with their way over the last {TAIL_FRAMES} frames."
    return Layer("ground truth", LayerKind.OVER, tuple(map(draw, view.frames)), legend=legend, description=description)


def _make_point_errors(view: SequenceView, variant: Variant, name: str) -> Layer:
    labelled = read_labelled_points(view.store, view.graph.leaves.labelled_points)

    def draw(frame: int) -> Picture:
        found = label_points(labelled, frame, view.labels(variant, frame))
        kinds = sort_errors(found.predicted, found.truth)
        # Errors lie above what is right.
        shown = np.concatenate([np.flatnonzero(kinds[kind]) for kind in ERROR_COLOURS])
        counts = [np.count_nonzero(kinds[kind]) for kind in ERROR_COLOURS]
        colours = np.repeat(np.array(list(ERROR_COLOURS.values()), np.uint8), counts, axis=0)
        seen = np.ones((len(shown), 1), bool)
        drawn = DrawnPoints(found.points[shown][:, None], seen, colours, found.size)
        return encode_transparent(draw_tracks(drawn, view.shape, POINT_RADIUS))

    description = "All moving objects taken as one, compared with the ground truth at its labelled points."
    pictures = tuple(map(draw, view.frames))
    return Layer(name, LayerKind.OVER, pictures, _list_errors(), description=description, is_beside=True)


def _list_errors() -> tuple[LegendEntry, ...]:
    return tuple(
        LegendEntry(as_hex(colour), f"{kind}: {_ERROR_MEANINGS[kind]}") for kind, colour in ERROR_COLOURS.items()
    )


def _read_truth(view: SequenceView, frame: int) -> np.ndarray | None:
    """Labels of a frame; None where it has none, as where no frame has any and all are shown."""
    annotation = view.graph.leaves.annotation
    annotated = annotated_frames(view.store, annotation)
    if frame not in annotated:
        return None
    row = annotated.index(frame)
    return view.store.read_rows(annotation, "masks", row, row + 1)[0]
