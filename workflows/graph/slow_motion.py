"""Distances of the pictures of pairs, which are settled before the rest of a sequence's graph is written."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.configs import SALIENCY_SOURCES, PipelineConfig
from moseg.schemas.recipes import Recipe
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES, SequenceLeaves
from moseg.workflows.graph.stretches import Stretch, cut_stretches

_PICTURES_PER_GAP = 8
"""Pictures that a scene has at least for each picture that the two of a pair are apart."""


class SlowMotionGaps:
    """Writer of the recipes of how far apart the pictures of pairs are, one for each stretch of a sequence.

    They are for saliency and for what judges its objects, and need flow between any two frames.
    """

    def __init__(self, leaves: SequenceLeaves, config: PipelineConfig):
        self._nodes = Nodes(leaves, config)
        self._params = config.slow_motion
        self._cues = FrameCues(self._nodes)
        num_frames = len(self._nodes.frames)
        self._longest = min(self._params.max_gap, len(self._cues.pictures) // _PICTURES_PER_GAP)
        is_read = config.proposal_source in SALIENCY_SOURCES and config.flow.method not in GIVEN_SOURCES
        is_searched = is_read and self._longest > 1
        stretches = cut_stretches(num_frames, self._params.stretch_length) if is_searched else ()
        # A video may end in a picture that stands for longer than a stretch.
        followed = self._cues.pictures.num_followed
        self._stretches = tuple(Stretch(start, min(stop, followed)) for start, stop in stretches if start < followed)
        self._num_frames = num_frames

    @property
    def recipes(self) -> dict[str, Recipe]:
        """Recipes written so far, by reference."""
        return self._nodes.recipes

    def refs(self) -> tuple[str, ...]:
        """Return the reference of each stretch's distance."""
        return tuple(map(self._search, self._stretches))

    def gaps(self, found: Sequence[int]) -> tuple[int, ...]:
        """Return the distance of every frame from those found in each stretch; nothing where all are 1."""
        if max(found, default=1) == 1:
            return ()
        stretches = zip(self._stretches, found, strict=True)
        gaps = [gap for stretch, gap in stretches for _ in range(*stretch)]
        # What follows shows the last picture.
        return (*gaps, *gaps[-1:] * (self._num_frames - len(gaps)))

    def _search(self, stretch: Stretch) -> str:
        num_frames = stretch.stop - stretch.start
        wanted = round(self._params.num_pairs * num_frames / self._params.stretch_length)
        num_pairs = min(max(wanted, self._params.min_pairs), max(self._params.num_pairs, self._params.min_pairs))
        firsts = sorted(set(np.linspace(stretch.start, stretch.stop - 1, num_pairs).round().astype(int).tolist()))
        flows = tuple(map(self._cues.flow_to_next, firsts))
        return self._nodes.add("slow_motion", {"flows": flows}, longest=self._longest)
