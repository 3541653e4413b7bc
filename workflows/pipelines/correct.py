"""An open run: one video whose corrections are changed again and again, with only what each change needs computed."""

import time
from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from importlib.metadata import version
from threading import RLock
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.cues import cues_behind
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceGraph, SequenceLeaves, make_graph
from moseg.workflows.pipelines.leaves import ingest_video
from moseg.workflows.pipelines.live_labels import LiveLabels, painted_of
from moseg.workflows.pipelines.placed_edits import NO_EDITS, PlacedEdits, with_edits
from moseg.workflows.pipelines.purpose import SEGMENTATION, Purpose, make_subject
from moseg.workflows.pipelines.segment import StoredSegmentation, read_stored, sinks_of
from moseg.workflows.results.found_objects import FoundObjects
from moseg.workflows.sources.described_frames import DescribedFrames

BEHIND_LEAVES = (
    *("linking", "identity", "components", "confidence", "moves_now", "track_objects", "rigid_support"),
    *("fundamental", "flow_model", "object_hypotheses", "affinity", "clustering", "moving_objects"),
    *("carrying", "growing"),
)
"""Stages whose parameters change nothing in the leaves of a graph, so that a video need not be read again for them."""


class Change(NamedTuple):
    """Result of corrections of a run.

    Attributes
    ----------
    found : FoundObjects
        All objects by identity, with their motion groups and names; those that are not in the result too.
    shown : tuple of int
        Identities of the objects of the result; of those without a pixel too.
    frames : tuple of int
        Frames whose labels may differ from those before, counted from 0; all, the first time.
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

    It holds what every change needs again: the leaves, the graph, and where objects and motion groups lie. Labels are
    made for the frames that are asked for, so that a change takes no longer in a longer video. Any thread may call its
    methods; one that computes makes others that compute wait.

    Parameters
    ----------
    session : Session
        It should keep cues: without them a change of settings computes everything again.
    source : SequenceSource
    variant : Variant
    purpose : Purpose
        What the run's log records about it.
    leaves, config : SequenceLeaves and PipelineConfig, optional
        Of a finished run, of which the video need not be read.
    """

    def __init__(
        self,
        session: Session,
        source: SequenceSource,
        variant: Variant = Variant.FUSED,
        purpose: Purpose = SEGMENTATION,
        leaves: SequenceLeaves | None = None,
        config: PipelineConfig | None = None,
    ):
        self._session, self._source, self._variant, self._purpose = session, source, variant, purpose
        # Corrections need no more of the video than this, so that it may be removed meanwhile.
        self._described = source._replace(frames=DescribedFrames(source.frames, source.frames.describe()))
        self._lock = RLock()
        self._graph = None if leaves is None else make_graph(leaves, config)
        self._config = config
        self._edits = NO_EDITS
        self._live: LiveLabels | None = None

    def apply(self, config: PipelineConfig, edits: PlacedEdits = NO_EDITS) -> Change:
        """Compute the labels under a configuration and edits, in place of those before.

        The first call computes whatever the store lacks, also cues if the session keeps them and the video was not
        opened from a finished run. If it raises, the result before stays in force.

        Raises
        ------
        InputError
            The video cannot be read, or an edit cannot be applied.
        """
        with self._lock:
            started, num_before = time.perf_counter(), self._session.computed.total()
            graphs: list[SequenceGraph] = []

            def build():
                graphs[:] = [self._write_graph(config, edits, is_repair=bool(graphs))]
                graph = graphs[0]
                objects = (*map(graph.objects.proposals, range(len(graph.sections))), graph.objects.linking())
                sinks = (*objects, graph.clustering(self._variant), *graph.object_areas(), *painted_of(graph))
                sinks = tuple(filter(None, sinks))
                if self._graph is None and self._session.keeps_cues:
                    # A run that did not keep them may have stored all the rest.
                    sinks = (*sinks, *cues_behind(graph.recipes, sinks))
                # After the graph is written, which finds the leaves of its weights.
                self._describe(graph.leaves, config)
                return graph.recipes, sinks

            def read():
                return LiveLabels(self._session.store, graphs[0], config, self._variant, edits)

            # What a slider passes is no result; `judge` keeps what the user stays with.
            live = self._session.compute(build, read, keeps=self._live is None)
            if self._live is None:
                import_kernels()
            frames = live.changed_frames(self._live)
            self._graph, self._config, self._edits, self._live = graphs[0], config, edits, live
            num_computed = self._session.computed.total() - num_before
            return Change(live.found, live.shown, frames, num_computed, time.perf_counter() - started)

    @property
    def num_frames(self) -> int:
        """Frames of the video."""
        return len(self._graph.leaves.frames)

    @property
    def analysed_shape(self) -> tuple[int, int]:
        """Height and width of the frames as analysed, and of `labels`, px."""
        return self._graph.leaves.shape

    @property
    def store(self) -> ArtifactStore:
        """The store that holds the frames and all that is computed from them."""
        return self._session.store

    @property
    def graph(self) -> SequenceGraph:
        """The graph of the corrections in force, whose references name everything that led to the result."""
        return self._graph

    @property
    def live(self) -> LiveLabels:
        """The labels of the corrections in force; they stay as they are if others come into force."""
        return self._live

    def labels(self, frame: int) -> np.ndarray:
        """Return the labels of one frame as analysed, uint16 (y, x): 0 static, else an identity."""
        return self._live.frame(frame)

    def image(self, frame: int) -> np.ndarray:
        """Return one frame as analysed, uint8 (y, x, 3) RGB."""
        return self._session.store.read(self._graph.leaves.frames[frame], "image")

    def judge(self) -> StoredSegmentation:
        """Compute what else is known about the result in force, and return all of it, as `segment` does.

        When objects move or rest, and how sure and complete they are: `apply` leaves that out, because it takes longer.
        """
        with self._lock:
            config, graphs = self._config, []

            def build():
                graphs[:] = [self._write_graph(config, self._edits, is_repair=True) if graphs else self._graph]
                return graphs[0].recipes, sinks_of(graphs[0], config, self._variant)

            def read():
                return read_stored(self._session.store, graphs[0], config, self._variant, self._described)

            return self._session.compute(build, read)

    def prepare_steps(self) -> tuple[Callable[[], None], ...]:
        """Return functions that compute what the first change of a setting would wait for, each in a short time.

        They measure how large the objects of all frames are, one section after the other.
        """
        with self._lock:
            sizes = self._config.moving_objects.model_copy(update={"min_area": 1.0})
            config = self._config.model_copy(update={"moving_objects": sizes})
            graph = self._graph.changed(self._graph.leaves, config)

        def measure(ref: str) -> None:
            with self._lock:
                self._session.compute(lambda: (graph.recipes, (ref,)), lambda: None, keeps=False)

        return tuple(partial(measure, ref) for ref in graph.object_areas())

    def repair(self, ref: str) -> None:
        """Compute an artifact behind the result again if it is damaged or missing; the video is read for its frames.

        Raises
        ------
        InputError
            The video cannot be read.
        StoreError
            It is not behind this result, or the store cannot hold it.
        """
        with self._lock:
            tries = []

            def build():
                tries.append(ref)
                recipes = self._graph.recipes
                if ref not in recipes or len(tries) > 1:
                    ingest_video(self._session, self._source, self._config)
                return recipes, [ref] if ref in recipes else []

            def read():
                for entry in self.store.manifest(ref).arrays:
                    self.store.read(ref, entry.name, check=True)

            self._session.compute(build, read, keeps=False)

    def _describe(self, leaves: SequenceLeaves, config: PipelineConfig) -> None:
        """Record the subject of the run in its log, so that it can be opened and reported without the video."""
        fps = self._purpose.fps or self._described.frames.describe().fps
        subject = make_subject(self._purpose, None, config, [self._variant], [(leaves, fps)])
        self._session.log.describe(subject)

    def _write_graph(self, config: PipelineConfig, edits: PlacedEdits, is_repair: bool) -> SequenceGraph:
        """Return the graph, of the leaves that are held where the configuration leaves them as they are.

        In a repair, after an artifact was damaged or lost, the video is read again: it may have been a leaf.
        """
        if not is_repair and self._graph is not None and _leading(config) == _leading(self._config):
            leaves = with_edits(self._session, self._described, self._graph.leaves, config, edits)
            return self._graph.changed(leaves, config)
        leaves = ingest_video(self._session, self._source, config)
        return make_graph(with_edits(self._session, self._described, leaves, config, edits), config)


def import_kernels() -> None:
    """Import what changes of settings run, so that the first of them is as fast as the next."""
    for name in ("affinity", "clustering", "rigid_support", "corrections.areas"):
        import_module(f"moseg.tasks.{name}")
    # The first change begins the log of the run, which has the version: what reads it is slow to import.
    version("moseg")


def _leading(config: PipelineConfig) -> Mapping[str, object]:
    """Return the parameters that may change the leaves, by stage."""
    return {name: getattr(config, name) for name in type(config).model_fields if name not in BEHIND_LEAVES}
