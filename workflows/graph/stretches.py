"""Stretches of a video, for each of which the camera's motion chooses the source of the proposals."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import SceneParallaxParams
from moseg.schemas.recipes import Recipe
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.pictures import Pictures
from moseg.workflows.graph.sequence_leaves import SequenceLeaves


class Stretch(NamedTuple):
    """Stretch start..stop of frames, or of sections."""

    start: int
    stop: int


def cut_stretches(number: int, length: int) -> tuple[Stretch, ...]:
    """Return stretches of `length` frames, or sections, that cover a number of them.

    A rest shorter than half of `length` joins the last one.
    """
    num_stretches = max((number + length // 2) // length, 1)
    starts = [index * length for index in range(num_stretches)]
    return tuple(map(Stretch, starts, [*starts[1:], number]))


class ReadStretch(NamedTuple):
    """A stretch with the frames on either side that are read with it.

    Attributes
    ----------
    read : Stretch
    place : dict of str to int
        Rows ``first`` .. ``last`` of the frames read that are those of the stretch itself: its place in the video
        changes no key.
    """

    read: Stretch
    place: dict[str, int]


def read_around(stretch: Stretch, window: int, number: int) -> ReadStretch:
    """Return a stretch of `number` frames with the changes of `window` frames before its first one and after its last.

    A change is that from the frame before, so one frame more is read at the beginning.
    """
    read = Stretch(max(stretch.start - 1 - window, 0), min(stretch.stop + window, number))
    return ReadStretch(read, {"first": stretch.start - read.start, "last": stretch.stop - read.start})


def choose_pairs(stretch: Stretch, params: SceneParallaxParams) -> list[tuple[int, int]]:
    """Return the first and last frame of the pairs of a stretch, spread over it evenly."""
    num_frames = stretch.stop - stretch.start
    gap = min(params.pair_gap, num_frames - 1)
    wanted = round(params.num_pairs * num_frames / params.stretch_length)
    num_pairs = min(max(wanted, params.min_pairs), max(params.num_pairs, params.min_pairs))
    firsts = np.linspace(stretch.start, stretch.stop - 1 - gap, num_pairs).round().astype(int)
    return [(first, first + gap) for first in sorted(set(firsts.tolist()))]


class Stretches:
    """Writer of the recipes of a sequence's choices, which are settled before the rest of its graph is written."""

    def __init__(self, leaves: SequenceLeaves, config: PipelineConfig):
        self._nodes = Nodes(leaves, config)
        self._params = config.scene_parallax
        self._frames = self._nodes.frames
        self._pictures = Pictures(self._frames, leaves.repetitions)
        self.stretches = cut_stretches(len(self._frames), config.scene_parallax.stretch_length)

    @property
    def recipes(self) -> dict[str, Recipe]:
        """Recipes written so far, by reference."""
        return self._nodes.recipes

    def choices(self) -> tuple[str, ...]:
        """Return the reference of each stretch's choice."""
        return tuple(map(self._choice, self.stretches))

    def _choice(self, stretch: Stretch) -> str:
        shown = self._pictures.distinct(*stretch)
        # Among repetitions of one picture the camera stands.
        shown = shown if len(shown) > 1 else list(range(*stretch))
        pairs = choose_pairs(Stretch(0, len(shown)), self._params)
        read = sorted({place for first, last in pairs for place in range(first, last + 1)})
        # By their places among the frames read: the stretch's place in the video changes no key.
        row_of = {place: row for row, place in enumerate(read)}
        rows = [(row_of[first], row_of[last]) for first, last in pairs]
        frames = tuple(self._frames[shown[place]] for place in read)
        return self._nodes.add("scene_parallax", {"frames": frames}, pairs=rows, **self._nodes.leaves.hidden())
