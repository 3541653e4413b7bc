"""Repetitions that were coded again, which are settled before the rest of a sequence's graph is written."""

from collections.abc import Sequence

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.recipes import Recipe
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.pictures import Pictures
from moseg.workflows.graph.sequence_leaves import SequenceLeaves
from moseg.workflows.graph.stretches import ReadStretch, Stretch, cut_stretches, read_around


class Repetitions:
    """Writer of the recipes of a sequence's repetitions, one for each stretch of it.

    Frames that were decoded to the same pixels are known to repeat: of each run of them one is read.
    """

    def __init__(self, leaves: SequenceLeaves, config: PipelineConfig):
        self._nodes = Nodes(leaves, config)
        self._params = config.repetitions
        pictures = Pictures(self._nodes.frames)
        self._shown = [pictures.frames(picture).start for picture in range(len(pictures))]
        # Two changes at least, one to be compared with the other.
        is_searched = self._params.max_change > 0 and len(self._shown) > 2
        self._stretches = cut_stretches(len(self._shown), self._params.stretch_length) if is_searched else ()

    @property
    def recipes(self) -> dict[str, Recipe]:
        """Recipes written so far, by reference."""
        return self._nodes.recipes

    def refs(self) -> tuple[str, ...]:
        """Return the reference of each stretch's repetitions."""
        return tuple(map(self._search, self._stretches))

    def frames(self, found: Sequence[Sequence[int]]) -> tuple[int, ...]:
        """Return the frames of the video that the rows found in each stretch are."""
        return tuple(
            self._shown[self._read(stretch).read.start + row]
            for stretch, rows in zip(self._stretches, found, strict=True)
            for row in rows
        )

    def _search(self, stretch: Stretch) -> str:
        read, place = self._read(stretch)
        frames = tuple(self._nodes.frames[self._shown[index]] for index in range(*read))
        return self._nodes.add("repetitions", {"frames": frames}, **place)

    def _read(self, stretch: Stretch) -> ReadStretch:
        return read_around(stretch, self._params.window, len(self._shown))
