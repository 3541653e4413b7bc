"""Cuts of a sequence, which end its scenes."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.stretches import cut_stretches, read_around


class SceneCuts(NamedTuple):
    """Cuts of a stretch.

    Attributes
    ----------
    ref : reference
    first : int
        Frame that the rows found are counted from.
    """

    ref: str
    first: int


def scene_cuts(nodes: Nodes) -> tuple[SceneCuts, ...]:
    """Write the recipe of the cuts of each stretch of a sequence, and return them; none in two frames."""
    params, frames = nodes.config.scene_cuts, nodes.frames
    if params.max_consistent == 0 or len(frames) < 3:
        return ()
    found = []
    for stretch in cut_stretches(len(frames), params.stretch_length):
        read, place = read_around(stretch, params.window, len(frames))
        inputs = {"frames": frames[read.start : read.stop]}
        found.append(SceneCuts(nodes.add("scene_cuts", inputs, **place), read.start))
    return tuple(found)


def read_cuts(stretches: Sequence[SceneCuts], attributes: Sequence[Mapping]) -> tuple[int, ...]:
    """Return the frames that begin another scene, from the attributes of each stretch's cuts."""
    return tuple(each.first + row for each, found in zip(stretches, attributes, strict=True) for row in found["cuts"])
