"""An open run: one video whose corrections are changed again and again, with only what each change needs computed."""

import time
from collections.abc import Mapping
from threading import RLock
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.pipelines.leaves import ingest_sequences
from moseg.workflows.pipelines.placed_edits import NO_EDITS, PlacedEdits, check_edits, with_edits
from moseg.workflows.pipelines.segment import StoredSegmentation, read_stored, sinks_of
from moseg.workflows.results.found_objects import FoundObjects, read_found_objects

BEHIND_LEAVES = (
    *("linking", "identity", "components", "confidence", "moves_now", "track_objects", "rigid_support"),
    *("fundamental", "flow_model", "object_hypotheses", "affinity", "clustering"),
)
"""Stages whose parameters change nothing in the leaves of a graph, so that a video need not be read again for them."""


class Change(NamedTuple):
    """What corrections made of a run.

    Attributes
    ----------
    found : FoundObjects
        All objects by identity, with their motion groups and names; those that are not in the result too.
    shown : tuple of int
        Identities of the objects of the result; of those without a pixel too.
    frames : tuple of int
        Frames whose labels differ from those before, counted from 0; all, the first time.
    num_computed : int
        Artifacts that had to be computed.
    seconds : float
        Wall time.
    """

    found: FoundObjects
    shown: tuple[int, ...]
    frames: tuple[int, ...]
    num_computed: int
    seconds: float


class OpenRun:
    """One video in a session, and the result of the corrections in force.

    It holds what every change needs again: the leaves, the graph, and the labels of all frames as analysed. Its methods
    may be called from any thread; one that computes makes the others wait.

    Parameters
    ----------
    session : Session
        It should keep cues: without them a change of settings computes everything again.
    source : SequenceSource
    variant : Variant
    """

    def __init__(self, session: Session, source: SequenceSource, variant: Variant = Variant.FUSED):
        self._session, self._source, self._variant = session, source, variant
        self._lock = RLock()
        self._leaves: SequenceLeaves | None = None
        self._graph: SequenceGraph | None = None
        self._config: PipelineConfig | None = None
        self._edits = NO_EDITS
        self._sections: tuple[tuple[str, np.ndarray], ...] = ()

    def apply(self, config: PipelineConfig, edits: PlacedEdits = NO_EDITS) -> Change:
        """Compute the labels under a configuration and edits, in place of those before.

        The first call computes whatever the store lacks. If it raises, the result before stays in force.

        Raises
        ------
        InputError
            The video cannot be read, or an edit cannot be applied.
        """
        with self._lock:
            started, num_before = time.perf_counter(), self._session.computed.total()
            graphs: list[SequenceGraph] = []

            def build():
                graphs[:] = [self._write_graph(config, edits)]
                check_edits(self._session, graphs[0], edits)
                refs = (graphs[0].clustering(self._variant), graphs[0].corrected_objects(self._variant))
                sinks = (*graphs[0].segmentations(self._variant), *filter(None, refs))
                return graphs[0].recipes, sinks

            def read():
                graph, store = graphs[0], self._session.store
                held = dict(self._sections)
                refs = graph.segmentations(self._variant)
                sections = tuple((ref, held[ref] if ref in held else store.read(ref, "labels")) for ref in refs)
                return (
                    sections,
                    read_found_objects(store, graph, self._variant),
                    _read_shown(store, graph, self._variant),
                )

            sections, found, shown = self._session.compute(build, read)
            frames = _changed_frames(self._sections, sections)
            self._graph, self._leaves, self._config = graphs[0], graphs[0].leaves, config
            self._edits, self._sections = edits, sections
            num_computed = self._session.computed.total() - num_before
            return Change(found, shown, frames, num_computed, time.perf_counter() - started)

    @property
    def num_frames(self) -> int:
        """Frames of the video."""
        return len(self._leaves.frames)

    @property
    def analysed_shape(self) -> tuple[int, int]:
        """Height and width of the frames as analysed, and of `labels`, px."""
        return self._leaves.shape

    @property
    def store(self) -> ArtifactStore:
        """The store that holds the frames and all that is computed from them."""
        return self._session.store

    @property
    def graph(self) -> SequenceGraph:
        """The graph of the corrections in force, whose references name everything that led to the result."""
        return self._graph

    def labels(self, frame: int) -> np.ndarray:
        """Return the labels of one frame as analysed, uint16 (y, x): 0 static, else an identity; read-only."""
        with self._lock:
            for _, labels in self._sections:
                if frame < len(labels):
                    return labels[frame]
                frame -= len(labels)
        raise IndexError(f"frame {frame} beyond the last one")

    def image(self, frame: int) -> np.ndarray:
        """Return one frame as analysed, uint8 (y, x, 3) RGB."""
        return self._session.store.read(self._leaves.frames[frame], "image")

    def judge(self) -> StoredSegmentation:
        """Compute what else is known about the result in force, and return all of it, as `segment` does.

        When objects move or rest, and how sure and complete they are: `apply` leaves that out, because it takes longer.
        """
        with self._lock:
            graph, config, edits = self._graph, self._config, self._edits

            def build():
                return graph.recipes, sinks_of(graph, config, self._variant)

            def read():
                return read_stored(self._session.store, graph, config, self._variant, self._source)

            del edits
            return self._session.compute(build, read)

    def _write_graph(self, config: PipelineConfig, edits: PlacedEdits) -> SequenceGraph:
        """Return the graph, of the leaves that are held where the configuration leaves them as they are."""
        leaves = self._leaves
        if leaves is None or _leading(config) != _leading(self._config):
            (leaves,) = ingest_sequences(self._session, [self._source], config, annotated=False)
        return SequenceGraph(with_edits(self._session, self._source, leaves, config, edits), config)


def _leading(config: PipelineConfig) -> Mapping[str, object]:
    """Return the parameters that may change the leaves, by stage."""
    return {name: getattr(config, name) for name in type(config).model_fields if name not in BEHIND_LEAVES}


def _read_shown(store: ArtifactStore, graph: SequenceGraph, variant: Variant) -> tuple[int, ...]:
    corrected = graph.corrected_objects(variant)
    if corrected is not None:
        return tuple(store.attributes(corrected)["shown"])
    found = read_found_objects(store, graph, variant)
    return tuple(identity for identity, motion in found.motions.items() if motion)


def _changed_frames(
    before: tuple[tuple[str, np.ndarray], ...], after: tuple[tuple[str, np.ndarray], ...]
) -> tuple[int, ...]:
    """Return the frames whose labels differ, of sections by reference."""
    if not before or [labels.shape for _, labels in before] != [labels.shape for _, labels in after]:
        return tuple(range(sum(len(labels) for _, labels in after)))
    changed, start = [], 0
    for (ref0, labels0), (ref1, labels1) in zip(before, after, strict=True):
        if ref0 != ref1:
            pairs = zip(labels0, labels1, strict=True)
            changed += [start + t for t, (each0, each1) in enumerate(pairs) if not np.array_equal(each0, each1)]
        start += len(labels1)
    return tuple(changed)
