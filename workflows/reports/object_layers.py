"""Layers of what was found: moving objects, all proposals, and their point tracks."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from operator import itemgetter

import numpy as np

from moseg.schemas.configs import Variant
from moseg.schemas.parameters.clustering import READ_TRACKS
from moseg.workflows.exports.draw_regions import RegionStyle, draw_regions
from moseg.workflows.exports.draw_tracks import TAIL_FRAMES, DrawnPoints, draw_tracks
from moseg.workflows.exports.overlay_style import DEFAULT_OPACITY
from moseg.workflows.reports.content import Layer, LayerKind, LegendEntry, Picture
from moseg.workflows.reports.layers import (
    PlannedLayer,
    SequenceView,
    all_colours,
    as_hex,
    encode_transparent,
    object_legend,
)
from moseg.workflows.results.found_objects import found_refs, read_found_objects

STATIC_POINT = (190, 190, 190)
"""RGB of points on static pixels."""
POINT_RADIUS = 1.5
"""px of the picture; a larger radius would hide small objects."""
_MOVING = RegionStyle(DEFAULT_OPACITY, is_numbered=True)
_PROPOSED = RegionStyle(0.15, is_numbered=True)


def plan_moving_objects(view: SequenceView, variant: Variant, is_shown: bool) -> PlannedLayer:
    """Plan the layer of the objects that move according to a variant."""
    name = f"moving objects ({variant})"

    def make() -> Layer:
        found = read_found_objects(view.store, view.graph, variant)
        return Layer(
            name,
            LayerKind.OVER,
            tuple(_draw_objects(view.labels(variant, frame), view.shape, _MOVING) for frame in view.frames),
            legend=object_legend(found, is_moving_only=True),
            description="Objects that move on their own, with one colour and number per identity in all frames.",
            is_shown=is_shown,
        )

    return PlannedLayer(name, (*view.label_refs(variant), *found_refs(view.graph, variant)), make)


def plan_proposals(view: SequenceView, variant: Variant) -> PlannedLayer:
    """Plan the layer of all objects, moving or static."""
    proposals = [view.graph.objects.proposals(section) for section in view.sections()]

    def make() -> Layer:
        found = read_found_objects(view.store, view.graph, variant)
        linked = view.store.read(view.graph.objects.linking(), "identity")
        names = np.array((0, *found.identities), np.uint16)

        def draw(frame: int) -> Picture:
            section, row = view.graph.place(frame)
            masks = view.store.read_rows(view.graph.objects.proposals(section), "masks", row, row + 1)[0]
            return _draw_objects(names[linked[section]][masks], view.shape, _PROPOSED)

        return Layer(
            "proposals",
            LayerKind.OVER,
            tuple(map(draw, view.frames)),
            legend=object_legend(found, is_moving_only=False),
            description=f"All proposed objects, linked over time, moving or static; motions are those of {variant}.",
        )

    return PlannedLayer("proposals", (*proposals, *found_refs(view.graph, variant)), make)


def reads_tracks(view: SequenceView, variants: Sequence[Variant]) -> bool:
    """Return whether any of the variants starts from point tracks."""
    params = view.config.clustering
    counts = params.motions == "auto" and params.auto in READ_TRACKS
    views = [view.config.views(variant) for variant in variants]
    return any("trajs" in models or (models and counts) for models in views)


def plan_tracks(view: SequenceView, variant: Variant) -> PlannedLayer:
    """Plan the layer of the point tracks with a short tail, in the colour of the object that they lie on."""
    tracks = [view.graph.motions.tracks(section) for section in view.sections()]

    def make() -> Layer:
        found = read_found_objects(view.store, view.graph, variant)
        linked = view.store.read(view.graph.objects.linking(), "identity")
        names = np.array((0, *found.identities), np.uint16)
        moves = np.array([0, *found.motions.values()]) > 0
        colours = np.where(moves[:, None], all_colours()[names], np.array(STATIC_POINT, np.uint8))

        def draw_section(section: int, rows: Iterable[int]) -> Iterator[Picture]:
            ref = view.graph.motions.tracks(section)
            points, visible, owner = (view.store.read(ref, name) for name in ("points", "visible", "object"))
            identity = linked[section][owner]
            # Moving points are drawn last, above static ones.
            order = np.argsort(moves[identity], kind="stable")
            drawn = DrawnPoints(points[order], visible[order], colours[identity[order]], view.graph.leaves.shape)
            for row in rows:
                yield encode_transparent(draw_tracks(drawn.until(row), view.shape, POINT_RADIUS))

        by_section = groupby(map(view.graph.place, view.frames), key=itemgetter(0))
        pictures = tuple(
            picture for section, places in by_section for picture in draw_section(section, (row for _, row in places))
        )
        static = LegendEntry(as_hex(STATIC_POINT), "on static pixels")
        return Layer(
            "tracks",
            LayerKind.OVER,
            pictures,
            legend=(*object_legend(found, is_moving_only=True), static),
            description=f"Point tracks with their paths over the last {TAIL_FRAMES} frames of their section, in the"
            f" colour of the object that they lie on; moving objects are those of {variant}.",
        )

    return PlannedLayer("tracks", (*tracks, *found_refs(view.graph, variant)), make)


def _draw_objects(labels: np.ndarray, shape: tuple[int, int], style: RegionStyle) -> Picture:
    """Draw objects as in the overlay: areas and outlines in the colours of identities."""
    return encode_transparent(draw_regions(labels, all_colours(), shape, style))
