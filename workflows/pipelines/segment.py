"""Segmenting a user's own video: labels of every frame at the video's own size."""

from collections.abc import Callable, Iterator, Mapping
from itertools import chain, repeat
from typing import NamedTuple, TypeVar

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.stretch_choice import StretchChoice
from moseg.store import ArtifactStore
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.cues import cues_behind
from moseg.workflows.engine.session import Session
from moseg.workflows.exports.black_bars import describe_bars
from moseg.workflows.exports.doubts import BY_HAND, Advice, advise
from moseg.workflows.exports.scene_cuts import describe_cuts
from moseg.workflows.exports.screen_graphics import describe_graphics
from moseg.workflows.graph import SequenceGraph, make_graph
from moseg.workflows.graph.black_bars import read_bars
from moseg.workflows.graph.scene_cuts import SceneCuts, read_cuts
from moseg.workflows.graph.screen_graphics import read_graphics
from moseg.workflows.pipelines.leaves import ingest_video
from moseg.workflows.pipelines.placed_edits import NO_EDITS, PlacedEdits, check_edits, with_edits
from moseg.workflows.pipelines.purpose import SEGMENTATION, Purpose, make_subject
from moseg.workflows.reports.panels import Panels
from moseg.workflows.results.evidence import Evidence, scene_evidence
from moseg.workflows.results.found_objects import read_found_objects, read_identities
from moseg.workflows.results.frame_cues import FrameCue, frame_cues
from moseg.workflows.results.scenes import scene_rows
from moseg.workflows.sources.resize import resize_labels

Result = TypeVar("Result")


class StoredSegmentation(NamedTuple):
    """Where the result of one video lies, and what was found.

    Attributes
    ----------
    name : str
    shape, analysed_shape : (int, int)
        Height and width of the video's frames, and of the frames as analysed, px.
    num_motions : int
        Motion groups found, the background's included.
    motions : dict of int to int
        Motion group of each object by identity; 0 = static, with the background.
    tags : dict of int to str
        Names that networks gave the objects, by identity; empty where there are none.
    rows : tuple of int
        What the rows of residuals and affinities stand for: 0, the background, then the identities of the objects
        before the user's edits.
    frame_refs, label_refs : tuple of references
        The frames, and the labels of every section.
    bars_ref, graphics_ref : reference
        The black bars of the frames, and the graphics drawn into them.
    are_bars_left_out, are_graphics_left_out : bool
        Whether they were filled for the analysis.
    evidence : Evidence
        What the motion groups come from, about each of `rows`.
    choices : tuple of StretchChoice
        Source of the proposals of each stretch, where it was left to the camera's motion.
    moves_refs, confidence_refs : tuple of references or None
        Whether objects move now, and how sure and complete they are, one a section; None for a section where that is
        not known.
    names : dict of int to str
        Names that the user gave the objects, by identity.
    drawn : frozenset of int
        Identities of which the user drew a part.
    advice : Advice
        What may help where a mask is too small or too large.
    cuts : tuple of SceneCuts
        Where the cuts of each stretch are stored.
    apart : tuple of int
        The frames that begin a scene that was segmented apart from the one before.
    cues : mapping of str to FrameCue
        Cues that the result was computed from, by name; their artifacts are stored if the run kept them.
    """

    name: str
    shape: tuple[int, int]
    analysed_shape: tuple[int, int]
    num_motions: int
    motions: dict[int, int]
    tags: dict[int, str]
    rows: tuple[int, ...]
    frame_refs: tuple[str, ...]
    label_refs: tuple[str, ...]
    bars_ref: str
    are_bars_left_out: bool
    graphics_ref: str
    are_graphics_left_out: bool
    evidence: Evidence
    choices: tuple[StretchChoice, ...] = ()
    moves_refs: tuple[str | None, ...] = ()
    confidence_refs: tuple[str | None, ...] = ()
    names: Mapping[int, str] = {}
    drawn: frozenset[int] = frozenset()
    advice: Advice = BY_HAND
    cuts: tuple[SceneCuts, ...] = ()
    apart: tuple[int, ...] = ()
    cues: Mapping[str, FrameCue] = {}

    @property
    def num_frames(self) -> int:
        """Frames of the video."""
        return len(self.frame_refs)

    @property
    def called(self) -> dict[int, str]:
        """The name of each object that has one, by identity: the user's, else that of a network."""
        return {**self.tags, **self.names}

    def frames(self, store: ArtifactStore) -> Iterator[np.ndarray]:
        """Yield frames as analysed, uint8 (y, x, 3) RGB, one at a time."""
        for ref in self.frame_refs:
            yield store.read(ref, "image")

    def about_picture(self, store: ArtifactStore) -> tuple[str, ...]:
        """Return what is worth a look in the frames themselves, whatever was found in them, in words."""
        bars = read_bars(store.attributes(self.bars_ref))
        graphics = read_graphics(store.attributes(self.graphics_ref))
        cuts = read_cuts(self.cuts, [store.attributes(each.ref) for each in self.cuts])
        about_bars = describe_bars(bars, self.analysed_shape, self.shape, self.are_bars_left_out)
        about_graphics = describe_graphics(graphics, self.analysed_shape, self.shape, self.are_graphics_left_out)
        return (*about_bars, *about_graphics, *describe_cuts(cuts, self.apart))

    def frame_labels(self, store: ArtifactStore, frame: int, shape: tuple[int, int] | None = None) -> np.ndarray:
        """Return labels uint16 (y, x) of one frame, counted from 0, at `shape` (the video's own size)."""
        for ref in self.label_refs:
            num_frames = store.manifest(ref).array("labels").shape[0]
            if frame < num_frames:
                return resize_labels(store.read_rows(ref, "labels", frame, frame + 1)[0], shape or self.shape)
            frame -= num_frames
        raise IndexError(f"frame {frame} beyond the last one")

    def labels(self, store: ArtifactStore, shape: tuple[int, int] | None = None) -> Iterator[np.ndarray]:
        """Yield labels uint16 (y, x) of every frame at `shape` (the video's own size): 0 static, else an identity."""
        for ref in self.label_refs:
            for index in range(store.manifest(ref).array("labels").shape[0]):
                labels = store.read_rows(ref, "labels", index, index + 1)[0]
                yield resize_labels(labels, shape or self.shape)

    def moves(self, store: ArtifactStore) -> Iterator[np.ndarray | None]:
        """Yield whether objects move in each frame, int8 (identity,): 1, 0, or -1 if unseen; None if not known."""
        yield from self._by_frame(store, self.moves_refs, "moves")

    def growths(self, store: ArtifactStore) -> Iterator[np.ndarray | None]:
        """Yield how its flow makes each object grow in each frame, float64 (identity,), NaN if unknown; or None."""
        yield from self._by_frame(store, self.moves_refs, "growth")

    def confidences(self, store: ArtifactStore) -> Iterator[tuple[np.ndarray, np.ndarray] | None]:
        """Yield expected precision and recall of objects in each frame, float64 (identity,), NaN if unseen; or None."""
        sure, complete = (self._by_frame(store, self.confidence_refs, name) for name in ("sure", "complete"))
        for both in zip(sure, complete, strict=True):
            yield None if both[0] is None else both

    def _by_frame(self, store: ArtifactStore, refs: tuple[str | None, ...], name: str) -> Iterator[np.ndarray | None]:
        """Yield the rows of an array of all sections, None for the frames of a section without a reference."""
        for ref, labels in zip(refs, self.label_refs, strict=True):
            if ref is None:
                yield from repeat(None, store.manifest(labels).array("labels").shape[0])
            else:
                yield from store.read(ref, name)


def segment(
    session: Session,
    source: SequenceSource,
    config: PipelineConfig,
    variant: Variant,
    use: Callable[[StoredSegmentation], Result],
    purpose: Purpose = SEGMENTATION,
    panels: Panels | None = None,
    edits: PlacedEdits = NO_EDITS,
) -> Result:
    """Segment one video, reusing every artifact that exists, and return what `use` makes of it.

    `use` is called again where it met a damaged artifact, once that is made again. A session that keeps cues computes
    those that an earlier run did not keep.

    Parameters
    ----------
    purpose : Purpose
        What the run's log records about it.
    panels : Panels, optional
        Gather what a report shows, before `use` is called.
    edits : PlacedEdits
        What the user corrects.

    Raises
    ------
    InputError
        The video cannot be read or has fewer than two frames, or an edit names what is not there.
    """
    graphs: list[SequenceGraph] = []

    def fps() -> float | None:
        return purpose.fps or source.frames.describe().fps

    def build():
        leaves = ingest_video(session, source, config)
        leaves = with_edits(session, source, leaves, config, edits)
        graphs[:] = [make_graph(leaves, config)]
        check_edits(session, graphs[0], edits)
        sinks = sinks_of(graphs[0], config, variant)
        if session.keeps_cues:
            # A run that did not keep them may have stored all the rest.
            sinks = (*sinks, *cues_behind(graphs[0].recipes, sinks))
        if panels is not None:
            sinks = (*sinks, *panels.sinks(graphs[0]))
        session.log.describe(make_subject(purpose, None, config, [variant], [(leaves, fps())]))
        return graphs[0].recipes, sinks

    def read():
        graph = graphs[0]
        if panels is not None:
            panels.gather(session.store, graph, fps())
        return use(read_stored(session.store, graph, config, variant, source))

    return session.compute(build, read)


def sinks_of(graph: SequenceGraph, config: PipelineConfig, variant: Variant) -> tuple[str, ...]:
    """Return the references that a `StoredSegmentation` reads: labels, then what is known about them."""
    clustering = graph.clustering(variant)
    beside = (*graph.moves_now(variant), *graph.confidences(variant))
    about_picture = (graph.black_bars(), graph.screen_graphics(), *(cuts.ref for cuts in graph.scene_cuts()))
    sinks = (*graph.segmentations(variant), *filter(None, beside), *about_picture)
    if clustering is None:
        return sinks
    return (*sinks, clustering, *chain.from_iterable(each.refs() for each in scene_evidence(graph, config, variant)))


def read_stored(
    store: ArtifactStore, graph: SequenceGraph, config: PipelineConfig, variant: Variant, source: SequenceSource
) -> StoredSegmentation:
    """Return where the result of a graph lies, whose sinks are stored."""
    found = read_found_objects(store, graph, variant)
    identities, _ = read_identities(store, graph)
    return StoredSegmentation(
        name=source.name,
        shape=source.frames.describe().size,
        analysed_shape=graph.leaves.shape,
        num_motions=found.num_motions,
        motions=found.motions,
        tags=found.tags,
        rows=(0, *identities),
        frame_refs=graph.leaves.frames,
        label_refs=graph.segmentations(variant),
        bars_ref=graph.black_bars(),
        are_bars_left_out=graph.leaves.bars is not None,
        graphics_ref=graph.screen_graphics(),
        are_graphics_left_out=graph.leaves.graphics is not None,
        evidence=Evidence(scene_evidence(graph, config, variant), scene_rows(store, graph)),
        choices=graph.leaves.choices,
        moves_refs=graph.moves_now(variant),
        confidence_refs=graph.confidences(variant),
        names=found.names,
        drawn=found.drawn,
        advice=advise(config, graph.leaves.choices),
        cuts=graph.scene_cuts(),
        apart=graph.leaves.cuts,
        cues={name: cue.without_graph() for name, cue in frame_cues(graph, config, [variant]).items()},
    )
