"""Layer of the dense tracks that no rigid scene explains, and of the objects that they form."""

from collections.abc import Iterable, Iterator
from itertools import groupby
from operator import itemgetter

import numpy as np

from moseg.schemas.configs import Variant
from moseg.workflows.exports.draw_tracks import TAIL_FRAMES, DrawnPoints, draw_tracks
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

DROPPED = (190, 190, 190)
"""RGB of tracks of objects with too little evidence to move."""
POINT_RADIUS = 1.0
"""px of the picture; dense tracks are about 2 px apart there."""


def plan_dense_tracks(view: SequenceView, variant: Variant) -> PlannedLayer:
    """Plan the layer of the tracks of moving objects in the colour of the object that they propose, with short tails.

    Frames of a section whose proposals are not made from dense tracks have no picture.
    """
    proposed = view.graph.objects.track_proposals
    tracked = [section for section in view.sections() if view.graph.objects.source_of(section) == "tracks"]
    refs = [
        ref
        for section in tracked
        for ref in (
            proposed.dense_tracks(section),
            proposed.objects(section),
            view.graph.objects.proposals(section),
        )
    ]

    def make() -> Layer:
        found = read_found_objects(view.store, view.graph, variant)
        linked = view.store.read(view.graph.objects.linking(), "identity")
        names = np.array((0, *found.identities), np.uint16)
        coloured: set[int] = set()

        def draw_section(section: int, rows: Iterable[int]) -> Iterator[Picture | None]:
            if section not in tracked:
                yield from (None for _ in rows)
                return
            tracks = proposed.dense_tracks(section)
            candidate = view.store.read(proposed.objects(section), "object")
            attributes = view.store.attributes(view.graph.objects.proposals(section))
            moves = np.array(attributes["is_moving"], bool)
            # Proposals that may be static are not drawn in colour; those of surfaces are no objects of tracks.
            chosen = np.array(attributes["candidates"], np.int64)[moves]
            colours = np.full((int(candidate.max(initial=0)) + 1, 3), DROPPED, np.uint8)
            identities = names[linked[section][1 : len(moves) + 1][moves]]
            colours[chosen] = all_colours()[identities]
            coloured.update(identities.tolist())
            # Objects that move are drawn last, above the others.
            drawn = np.flatnonzero(candidate)
            drawn = drawn[np.argsort(np.isin(candidate[drawn], chosen), kind="stable")]
            points, visible = (view.store.read(tracks, name)[drawn] for name in ("points", "visible"))
            shown = DrawnPoints(points, visible, colours[candidate[drawn]], view.graph.leaves.shape)
            start = proposed.first_row(section)
            for row in rows:
                yield encode_transparent(draw_tracks(shown.until(start + row), view.shape, POINT_RADIUS))

        by_section = groupby(map(view.graph.place, view.frames), key=itemgetter(0))
        pictures = tuple(
            picture for section, places in by_section for picture in draw_section(section, (row for _, row in places))
        )
        moving = found._replace(motions={name: found.motions[name] for name in found.motions if name in coloured})
        return Layer(
            "dense tracks",
            LayerKind.OVER,
            pictures,
            legend=(*object_legend(moving, is_moving_only=False), LegendEntry(as_hex(DROPPED), "too little evidence")),
            description="Groups of dense tracks that no rigid scene explains, with their paths over the last"
            f" {TAIL_FRAMES} frames, in the colour of the object that they propose.",
        )

    return PlannedLayer("dense tracks", (*refs, *found_refs(view.graph, variant)), make)
