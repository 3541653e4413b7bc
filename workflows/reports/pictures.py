"""The pictures of a sequence or clip in a report, gathered from a store without computing anything."""

from collections.abc import Sequence

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.clip_pictures import gather_clip_pictures
from moseg.workflows.reports.cue_layers import plan_cue_layers
from moseg.workflows.reports.missing import Missing, WhyAbsent, say_missing
from moseg.workflows.reports.object_layers import plan_moving_objects, plan_proposals, plan_tracks, reads_tracks
from moseg.workflows.reports.object_rows import list_objects
from moseg.workflows.reports.overlay_video import encode_video
from moseg.workflows.reports.planned_layer import PlannedLayer, SequencePictures, make_layers
from moseg.workflows.reports.sequence_view import SequenceView
from moseg.workflows.reports.truth_layers import plan_errors, plan_truth
from moseg.workflows.results.shown_frames import scored_frames, spread

__all__ = ["SequencePictures", "gather_clip_pictures", "gather_pictures", "picture_refs"]


def gather_pictures(
    store: ArtifactStore,
    graph: SequenceGraph,
    config: PipelineConfig,
    variants: Sequence[Variant],
    num_frames: int,
    fps: float,
    why_absent: WhyAbsent = WhyAbsent.GONE,
) -> SequencePictures:
    """Pictures of a sequence, one frame in memory at a time.

    What lacks an artifact is left out, and `missing` says so.

    Parameters
    ----------
    variants : sequence of Variant
        At least one; video, table of objects, proposals' motions and tracks' colours are the first one's.
    num_frames : int
        Frames shown, spread evenly over the annotated ones, over all where there is no ground truth; all of them where
        there are fewer.
    fps : float
        Frames of the sequence per second of video.
    why_absent : WhyAbsent
        What to say of artifacts that are not stored.

    Raises
    ------
    CorruptArtifactError
        An artifact's bytes are not those committed.
    """
    frames, missing = _shown_frames(store, graph, num_frames)
    view = SequenceView(store, graph, config, frames)
    layers, without = make_layers(store, _plan_layers(view, variants))
    objects, unlisted = list_objects(view, variants[0], fps)
    video, unseen = encode_video(view, variants[0], fps)
    return SequencePictures(
        num_frames=len(graph.leaves.frames),
        shape=tuple(graph.leaves.shape),
        frames=frames,
        layers=layers,
        objects=objects,
        video=video,
        missing=say_missing((*missing, *without, *unlisted, *unseen), why_absent),
    )


def picture_refs(
    graph: SequenceGraph, config: PipelineConfig, variants: Sequence[Variant], num_frames: int
) -> tuple[str, ...]:
    """References that `gather_pictures` reads: sinks of a run that ends with a report.

    Which frames have ground truth is not asked here: where there is any, the cues of all frames are named. An
    evaluation makes them anyway.
    """
    leaves = graph.leaves
    has_truth = leaves.annotation is not None or leaves.labelled_points is not None
    every = len(leaves.frames)
    view = SequenceView(None, graph, config, spread(every, every if has_truth else num_frames))
    shown = (ref for layer in _plan_layers(view, variants) for ref in layer.refs)
    return tuple(dict.fromkeys((*shown, *leaves.frames, *graph.segmentations(variants[0]))))


def _shown_frames(
    store: ArtifactStore, graph: SequenceGraph, num_frames: int
) -> tuple[tuple[int, ...], tuple[Missing, ...]]:
    """The frames shown, and a sentence where they are not those that have ground truth."""
    leaves = graph.leaves
    every = spread(len(leaves.frames), num_frames)
    truth = leaves.annotation or leaves.labelled_points
    if truth is not None and not store.has(truth):
        return every, ("The ground truth is no longer in the store.",)
    shown = scored_frames(store, leaves)
    if not shown:
        return every, ("No frame has ground truth.",)
    return tuple(shown[position] for position in spread(len(shown), num_frames)), ()


def _plan_layers(view: SequenceView, variants: Sequence[Variant]) -> list[PlannedLayer]:
    """All layers of a sequence: opaque ones, then what lies over them, what hides least last."""
    layers = plan_cue_layers(view, variants)
    layers += [plan_moving_objects(view, variant, variant == variants[0]) for variant in variants]
    over = [plan_truth(view), *(plan_errors(view, variant) for variant in variants)]
    layers += [layer for layer in over if layer is not None]
    layers.append(plan_proposals(view, variants[0]))
    if reads_tracks(view, variants):
        layers.append(plan_tracks(view, variants[0]))
    return layers
