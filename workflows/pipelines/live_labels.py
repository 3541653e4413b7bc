"""Labels of single frames under edits, from the objects of their section, without an artifact of their own."""

from bisect import bisect_right
from collections.abc import Iterator
from itertools import pairwise
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.placed_edits import PlacedEdits
from moseg.workflows.results.found_objects import FoundObjects, read_identities, read_names
from moseg.workflows.stages.corrected_objects import object_names, small_of
from moseg.workflows.stages.inputs import ArtifactView


class _LiveSection(NamedTuple):
    """Inputs of the labels of a section's frames."""

    start: int
    stop: int
    masks: ArtifactView
    objects: np.ndarray
    painted: ArtifactView | None


class LiveLabels:
    """Labels under the edits of a graph whose motion groups, proposals and painted labels are stored.

    They are those that the recipes of its segmentation give, byte for byte, because the same function makes them.

    Attributes
    ----------
    found : FoundObjects
    shown : tuple of int
        Identities of the objects of the result.
    """

    def __init__(
        self, store: ArtifactStore, graph: SequenceGraph, config: PipelineConfig, variant: Variant, edits: PlacedEdits
    ):
        from moseg.tasks.corrections.relabel import label_tables
        from moseg.tasks.corrections.replay import replay_steps
        from moseg.tasks.corrections.steps import steps_of

        linking, clustering = ArtifactView(store, graph.objects.linking()), graph.clustering(variant)
        names = object_names(linking.attributes)
        motion = np.arange(len(names)) if clustering is None else ArtifactView(store, clustering).cached("motion")
        motions = dict(zip(names[1:].tolist(), motion[1:].tolist(), strict=True))
        areas = [ArtifactView(store, ref) for ref in graph.object_areas()]
        small = small_of(linking, areas, config.moving_objects.min_area) if areas else ()
        corrected = replay_steps(steps_of(edits.edits), motions, len(graph.leaves.frames), edits.places, small)
        self.shown = tuple(sorted(corrected.shown))
        self.found = _found(store, graph, corrected.motions)
        self._tables = label_tables(corrected)
        self._labels_at = _LabelsOverTime(self._tables.labels), _LabelsOverTime(self._tables.stroke_labels)
        identity = linking.cached("identity")
        self._sections = [
            _LiveSection(
                section.start,
                section.stop,
                ArtifactView(store, graph.objects.proposals(index)),
                names[identity[index]],
                None if painted is None else ArtifactView(store, painted),
            )
            for index, (section, painted) in enumerate(zip(graph.sections, painted_of(graph), strict=True))
        ]

    def frame(self, frame: int) -> np.ndarray:
        """Return the labels of one frame as analysed, uint16 (y, x): 0 static, else an identity."""
        from moseg.tasks.corrections.relabel import relabel_section

        section = self._section_of(frame)
        t = frame - section.start
        # The whole section, because the frames beside this one are asked for next.
        masks = section.masks.cached("masks")[t : t + 1]
        if section.painted is None:
            return relabel_section(masks, section.objects, self._tables, frame)[0]
        painted = section.painted.cached("painted")[t : t + 1]
        erased = section.painted.attributes.get("erased", ())
        return relabel_section(masks, section.objects, self._tables, frame, painted, erased)[0]

    def areas(self, frame: int, mask_areas: np.ndarray) -> np.ndarray:
        """Return the area of each label of a frame, int64 (label,), px as analysed; of labels beyond them it is 0.

        Where nothing is painted the pixels need not be read.

        Parameters
        ----------
        frame : int
        mask_areas : int64 (value,)
            Number of pixels of each value of the frame's proposals.
        """
        from moseg.tasks.corrections.relabel import relabel_section

        section = self._section_of(frame)
        if section.painted is not None:
            return np.bincount(self.frame(frame).ravel())
        values = np.arange(len(mask_areas), dtype=np.uint16)
        labels = relabel_section(values[None, None], section.objects, self._tables, frame)[0, 0]
        return np.bincount(labels, weights=mask_areas).astype(np.int64)

    def changed_frames(self, before: "LiveLabels | None") -> tuple[int, ...]:
        """Return the frames whose labels may differ from those before; all if there are none before."""
        stop = self._sections[-1].stop
        if before is None or stop != before._sections[-1].stop:
            return tuple(range(stop))
        # From one of these to the next, the same decides the labels of every frame.
        starts = sorted({*self._starts(), *before._starts()})
        changed: list[int] = []
        for first, last in pairwise([*starts, stop]):
            if self._origin(first) != before._origin(first):
                changed += range(first, last)
        return tuple(changed)

    def _starts(self) -> Iterator[int]:
        """Yield the frames at which a section begins, or an object becomes another one."""
        yield from (section.start for section in self._sections)
        tables = self._tables
        columns = [
            *(table[:, 1] for table in (tables.labels, tables.stroke_labels)),
            *(table[:, column] for table in (tables.members, tables.stroke_members) for column in (2, 3)),
        ]
        yield from (first for column in columns for first in column.tolist() if first < self._sections[-1].stop)

    def _origin(self, frame: int) -> tuple:
        """Return what decides the labels of a frame, to be compared with that of another result."""
        objects, strokes = (labels_at(frame) for labels_at in self._labels_at)
        section = self._section_of(frame)
        labels = tuple(objects.get(each, 0) for each in section.objects.tolist())
        if section.painted is None:
            return section.start, section.masks.ref, labels
        return section.start, section.masks.ref, labels, section.painted.ref, strokes, self._erased_at(section, frame)

    def _erased_at(self, section: _LiveSection, frame: int) -> tuple[list[int], ...]:
        """Return the objects and strokes that those strokes of a section erase in a frame that erase single objects."""
        from moseg.tasks.corrections.relabel import members_at

        tables = self._tables.members, self._tables.stroke_members
        entries = section.painted.attributes.get("erased", ())
        return tuple(members_at(table, numbers, frame) for _, *numbers in entries for table in tables)

    def _section_of(self, frame: int) -> _LiveSection:
        if not 0 <= frame < self._sections[-1].stop:
            raise IndexError(f"no frame {frame}")
        return self._sections[bisect_right(self._sections, frame, key=attrgetter("start")) - 1]


class _LabelsOverTime:
    """Labels of the objects of a table in any frame; they are made once for each frame at which some change."""

    def __init__(self, table: np.ndarray):
        self._table, self._starts = table, sorted({0, *table[:, 1].tolist()})
        self._known: dict[int, dict[int, int]] = {}

    def __call__(self, frame: int) -> dict[int, int]:
        from moseg.tasks.corrections.relabel import labels_at

        start = self._starts[bisect_right(self._starts, frame) - 1]
        if start not in self._known:
            self._known[start] = labels_at(self._table, start)
        return self._known[start]


def painted_of(graph: SequenceGraph) -> tuple[str | None, ...]:
    """Return the references of what was painted in every section."""
    return tuple(map(graph.painted, range(len(graph.sections))))


def _found(store: ArtifactStore, graph: SequenceGraph, motions: dict[int, int]) -> FoundObjects:
    _, tags = read_identities(store, graph)
    kept = {identity: tag for identity, tag in tags.items() if identity in motions}
    return FoundObjects(tuple(motions), motions, len({0, *motions.values()}), kept, read_names(graph))
