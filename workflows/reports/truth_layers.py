"""Layers of the ground truth and of each variant's errors."""

from collections.abc import Callable

import numpy as np

from moseg.schemas.configs import Variant
from moseg.workflows.exports.draw_errors import ERROR_COLOURS, sort_errors
from moseg.workflows.exports.draw_regions import HATCH, RegionStyle, draw_regions
from moseg.workflows.exports.draw_tracks import TAIL_FRAMES, DrawnPoints, draw_tracks
from moseg.workflows.reports.content import Layer, LayerKind, LegendEntry, Picture
from moseg.workflows.reports.layers import PlannedLayer, SequenceView, as_hex, encode_transparent
from moseg.workflows.reports.object_layers import POINT_RADIUS, STATIC_POINT
from moseg.workflows.results.shown_frames import annotated_frames, label_points, read_labelled_points
from moseg.workflows.sources.resize import resize_labels

TRUTH_COLOUR = (255, 255, 255)
"""RGB of no identity: true objects and found ones share no numbers."""
_TRUTH = RegionStyle(0.2)
_ERRORS = RegionStyle(0.7, line=0)
_MEANINGS = {
    "true positive": "moves, and was found",
    "false positive": "found, but does not move",
    "false negative": "moves, but was not found",
}


def plan_truth(view: SequenceView) -> PlannedLayer | None:
    """Plan the layer of what truly moves; None where there is no ground truth."""
    if view.graph.leaves.annotation is not None:
        return PlannedLayer("ground truth", (view.graph.leaves.annotation,), lambda: _make_truth(view))
    if view.graph.leaves.labelled_points is not None:
        return PlannedLayer("ground truth", (view.graph.leaves.labelled_points,), lambda: _make_true_points(view))
    return None


def plan_errors(view: SequenceView, variant: Variant) -> PlannedLayer | None:
    """Plan the layer of where a variant is right or wrong; None where there is no ground truth."""
    leaves = view.graph.leaves
    truth = leaves.annotation or leaves.labelled_points
    if truth is None:
        return None
    name = f"errors ({variant})"

    def make() -> Layer:
        is_dense = leaves.annotation is not None
        draw = _error_drawer(view, variant) if is_dense else _point_error_drawer(view, variant)
        where = "pixel by pixel" if is_dense else "at its labelled points"
        legend = (LegendEntry(as_hex(colour), f"{kind}: {_MEANINGS[kind]}") for kind, colour in ERROR_COLOURS.items())
        description = f"All moving objects taken as one, compared with the ground truth {where}."
        pictures = tuple(map(draw, view.frames))
        return Layer(name, LayerKind.OVER, pictures, tuple(legend), description=description, is_beside=True)

    return PlannedLayer(name, (truth, *view.label_refs(variant)), make)


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
        legend += (LegendEntry(as_hex(HATCH), "striped: not counted"),)
    description = "What truly moves, each object with a border of its own."
    return Layer("ground truth", LayerKind.OVER, tuple(map(draw, view.frames)), legend=legend, description=description)


def _error_drawer(view: SequenceView, variant: Variant) -> Callable[[int], Picture | None]:
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

    return draw


def _make_true_points(view: SequenceView) -> Layer:
    points, visible, labels, size = read_labelled_points(view.store, view.graph.leaves.labelled_points)
    order = np.argsort(labels > 0, kind="stable")
    colours = np.where((labels > 0)[:, None], np.array(TRUTH_COLOUR), np.array(STATIC_POINT) // 2).astype(np.uint8)
    drawn = DrawnPoints(points[order], visible[order], colours[order], size)
    pictures = tuple(
        encode_transparent(draw_tracks(drawn.until(frame), view.shape, POINT_RADIUS)) for frame in view.frames
    )
    legend = (
        LegendEntry(as_hex(TRUTH_COLOUR), "moves"),
        LegendEntry(as_hex(np.array(STATIC_POINT) // 2), "static"),
    )
    description = f"Labelled points with their paths over the last {TAIL_FRAMES} frames."
    return Layer("ground truth", LayerKind.OVER, pictures, legend=legend, description=description)


def _point_error_drawer(view: SequenceView, variant: Variant) -> Callable[[int], Picture]:
    labelled = read_labelled_points(view.store, view.graph.leaves.labelled_points)

    def draw(frame: int) -> Picture:
        found = label_points(labelled, frame, view.labels(variant, frame))
        kinds = sort_errors(found.predicted, found.truth)
        # Errors are drawn last, above correct points.
        shown = np.concatenate([np.flatnonzero(kinds[kind]) for kind in ERROR_COLOURS])
        counts = [np.count_nonzero(kinds[kind]) for kind in ERROR_COLOURS]
        colours = np.repeat(np.array(list(ERROR_COLOURS.values()), np.uint8), counts, axis=0)
        seen = np.ones((len(shown), 1), bool)
        drawn = DrawnPoints(found.points[shown][:, None], seen, colours, found.size)
        return encode_transparent(draw_tracks(drawn, view.shape, POINT_RADIUS))

    return draw


def _read_truth(view: SequenceView, frame: int) -> np.ndarray | None:
    """Read the labels of a frame; None where it has none, as where no frame has any and all are shown."""
    annotation = view.graph.leaves.annotation
    annotated = annotated_frames(view.store, annotation)
    if frame not in annotated:
        return None
    row = annotated.index(frame)
    return view.store.read_rows(annotation, "masks", row, row + 1)[0]
