"""Scenes of a video that were segmented apart: their objects, and their names in words."""

from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph


def scene_rows(store: ArtifactStore, graph: SequenceGraph) -> tuple[range, ...]:
    """Return which of the video's objects, counted from 1, are those of each scene."""
    rows, start = [], 1
    for scene in graph.scenes:
        stop = start + store.attributes(scene.objects.linking())["num_objects"] - 1
        rows.append(range(start, stop))
        start = stop
    return tuple(rows)


def spell_scenes(graph: SequenceGraph) -> tuple[str, ...]:
    """Return the frames of each scene in words; an empty text where there is a single scene."""
    if len(graph.scenes) == 1:
        return ("",)
    stops = (*graph.first_frames[1:], len(graph.leaves.frames))
    return tuple(
        f"frame {first}" if stop == first + 1 else f"frames {first} to {stop - 1}"
        for first, stop in zip(graph.first_frames, stops, strict=True)
    )
