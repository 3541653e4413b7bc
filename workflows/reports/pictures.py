"""Pictures, video and table of objects of a sequence in a report, gathered from a store without computing anything."""

import math
from collections.abc import Iterator, Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.exports.summarise import summarise_sequence
from moseg.workflows.exports.write_overlay import encode_overlay
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.content import MaskArchive, ObjectRow, ObjectTimeline, SequencePanel, Video
from moseg.workflows.reports.cue_layers import plan_cue_layers
from moseg.workflows.reports.dense_track_layer import plan_dense_tracks
from moseg.workflows.reports.layers import (
    PICTURE_SIDE,
    PlannedLayer,
    SequenceView,
    all_colours,
    as_hex,
    make_layers,
    merge_layers,
)
from moseg.workflows.reports.mask_archive import MaskArchiver
from moseg.workflows.reports.missing import Missing, WhyAbsent, format_missing, name_absent
from moseg.workflows.reports.object_layers import plan_moving_objects, plan_proposals, plan_tracks, reads_tracks
from moseg.workflows.reports.timelines import make_timelines
from moseg.workflows.reports.truth_layers import plan_errors, plan_truth
from moseg.workflows.results.found_objects import found_refs, read_found_objects
from moseg.workflows.results.mask_history import MaskHistory
from moseg.workflows.results.shown_frames import scored_frames, spread

CONSTANT_RATE_FACTOR = 28
"""Of x264: at the size of a report its loss is hardly visible, and ten seconds take some hundred kilobytes."""
MAX_VIDEO_FRAMES = 900
"""Half a minute of a video at 30 frames per second; of longer ones every n-th frame is shown."""


class _FollowedObjects(NamedTuple):
    """The moving objects of a sequence: table, timelines and masks."""

    rows: tuple[ObjectRow, ...] = ()
    timelines: tuple[ObjectTimeline, ...] = ()
    masks: MaskArchive | None = None


def gather_pictures(
    store: ArtifactStore,
    graph: SequenceGraph,
    config: PipelineConfig,
    variants: Sequence[Variant],
    num_frames: int,
    fps: float,
    why_absent: WhyAbsent = WhyAbsent.GONE,
) -> SequencePanel:
    """Gather the panel of a sequence without its variants, one frame in memory at a time.

    What lacks an artifact is left out, and `missing` names it.

    Parameters
    ----------
    variants : sequence of Variant
        At least one; video, table of objects, proposals' motions and tracks' colours are those of the first.
    num_frames : int
        Frames shown, spread evenly over the annotated ones, over all where there is no ground truth; all of them where
        there are fewer.
    fps : float
        Frames of the sequence per second of video.
    why_absent : WhyAbsent
        Reason that is given for artifacts that are not stored.

    Raises
    ------
    CorruptArtifactError
        An artifact's bytes are not those committed.
    """
    frames, missing = _shown_frames(store, graph, num_frames)
    view = SequenceView(store, graph, config, frames)
    layers, absent = make_layers(store, _plan_layers(view, variants))
    missing += absent
    objects = _follow_objects(view, variants[0], fps, missing)
    return SequencePanel(
        name=graph.leaves.name,
        num_frames=len(graph.leaves.frames),
        shape=tuple(graph.leaves.shape),
        frames=frames,
        layers=merge_layers(layers),
        objects=objects.rows,
        timelines=objects.timelines,
        masks=objects.masks,
        video=_encode_video(view, variants[0], fps, missing),
        missing=format_missing(missing, why_absent),
    )


def picture_refs(
    graph: SequenceGraph, config: PipelineConfig, variants: Sequence[Variant], num_frames: int
) -> tuple[str, ...]:
    """Return the references that `gather_pictures` reads: sinks of a run that ends with a report.

    The annotated frames are not known here: where there is ground truth, the cues of all frames are named. An
    evaluation computes them anyway.
    """
    leaves = graph.leaves
    has_truth = leaves.annotation is not None or leaves.labelled_points is not None
    every = len(leaves.frames)
    view = SequenceView(None, graph, config, spread(every, every if has_truth else num_frames))
    shown = (ref for layer in _plan_layers(view, variants) for ref in layer.refs)
    return tuple(dict.fromkeys((*shown, *leaves.frames, *graph.segmentations(variants[0]))))


def video_frames(num_frames: int) -> range:
    """Return the frames of a sequence that the video and the archive of masks hold, evenly spaced."""
    return range(0, num_frames, math.ceil(num_frames / MAX_VIDEO_FRAMES))


def _shown_frames(store: ArtifactStore, graph: SequenceGraph, num_frames: int) -> tuple[tuple[int, ...], list[Missing]]:
    """Return the frames shown, and a sentence where they are not those that have ground truth."""
    leaves = graph.leaves
    every = spread(len(leaves.frames), num_frames)
    truth = leaves.annotation or leaves.labelled_points
    if truth is not None and not store.has(truth):
        return every, ["The ground truth is no longer in the store."]
    shown = scored_frames(store, leaves)
    if not shown:
        return every, ["No frame has ground truth."]
    return tuple(shown[position] for position in spread(len(shown), num_frames)), []


def _plan_layers(view: SequenceView, variants: Sequence[Variant]) -> list[PlannedLayer]:
    """Plan all layers of a sequence: opaque ones, then those that lie over them, from the one that hides most."""
    layers = plan_cue_layers(view, variants)
    layers += [plan_moving_objects(view, variant, variant == variants[0]) for variant in variants]
    over = [plan_truth(view), *(plan_errors(view, variant) for variant in variants)]
    layers += [layer for layer in over if layer is not None]
    layers.append(plan_proposals(view, variants[0]))
    if any(view.graph.objects.source_of(section) == "tracks" for section in view.sections()):
        layers.append(plan_dense_tracks(view, variants[0]))
    if reads_tracks(view, variants):
        layers.append(plan_tracks(view, variants[0]))
    return layers


def _follow_objects(view: SequenceView, variant: Variant, fps: float, missing: list[Missing]) -> _FollowedObjects:
    """Follow what moves through all frames of the sequence; add to `missing` where artifacts are absent."""
    frames = range(len(view.graph.leaves.frames))
    refs = {*view.label_refs(variant, frames), *found_refs(view.graph, variant)}
    if absent := refs - view.store.present(refs):
        missing.append(name_absent("table of objects", absent))
        return _FollowedObjects()
    found = read_found_objects(view.store, view.graph, variant)
    history, archiver = MaskHistory(), MaskArchiver()
    archived = set(video_frames(len(frames)))

    def read_labels() -> Iterator[np.ndarray]:
        for frame in frames:
            labels = view.labels(variant, frame)
            history.add(labels)
            if frame in archived:
                archiver.add(frame, labels)
            yield labels

    name = view.graph.leaves.name
    moves = _read_frames(view, view.graph.moves_now(variant), "moves")
    sure, complete = (_read_frames(view, view.graph.confidences(variant), key) for key in ("sure", "complete"))
    confidences = None if sure is None or complete is None else zip(sure, complete, strict=True)
    known = {"moves": moves, "confidences": confidences}
    summary = summarise_sequence(name, read_labels(), fps, found.num_motions, found.motions, found.called, **known)
    colours = all_colours()
    rows = tuple(
        ObjectRow(
            identity=each.identity,
            colour=as_hex(colours[each.identity]),
            motion=each.motion,
            first_frame=each.first_frame,
            last_frame=each.last_frame,
            num_frames=each.num_frames,
            mean_area_percent=100 * each.mean_area_fraction,
            tag=each.tag,
            num_moving=_count(each.moving_frames),
            sure_percent=None if each.sure is None else 100 * each.sure,
            complete_percent=None if each.complete is None else 100 * each.complete,
        )
        for each in summary.objects
    )
    timelines = make_timelines(view, variant, history, summary.objects)
    return _FollowedObjects(rows, timelines, archiver.finish() if rows else None)


def _read_frames(view: SequenceView, refs: tuple[str | None, ...], name: str) -> Iterator[np.ndarray] | None:
    """Return the rows of an array of all sections; None where a run did not ask for it, or not in all frames."""
    if None in refs or {*refs} - view.store.present({*refs}):
        return None
    return chain.from_iterable(view.store.read(ref, name) for ref in refs)


def _count(runs: tuple[tuple[int, int], ...] | None) -> int | None:
    return None if runs is None else sum(last - first + 1 for first, last in runs)


def _encode_video(view: SequenceView, variant: Variant, fps: float, missing: list[Missing]) -> Video | None:
    """Encode the overlay of a variant at `fps` frames of the sequence per second; add to `missing` what it lacks."""
    leaves = view.graph.leaves
    frames = video_frames(len(leaves.frames))
    step = frames.step
    refs = {*(leaves.frames[frame] for frame in frames), *view.label_refs(variant, frames)}
    if absent := refs - view.store.present(refs):
        missing.append(name_absent(f"video of {variant}", absent))
        return None
    data = encode_overlay(
        (view.store.read(leaves.frames[frame], "image") for frame in frames),
        (view.labels(variant, frame) for frame in frames),
        fps / step,
        crf=CONSTANT_RATE_FACTOR,
        max_side=PICTURE_SIDE,
    )
    if step > 1:
        missing.append(f"The video shows one frame in {step} of {len(leaves.frames)}.")
    height, width = (side + side % 2 for side in view.shape)
    return Video(data, width, height, fps / step, step)
