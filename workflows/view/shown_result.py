"""A result as the page shows it: frames, labels, and all objects of which it is chosen what moves."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.live_labels import LiveLabels
from moseg.workflows.reports.layers import SequenceView
from moseg.workflows.results.found_objects import FoundObjects, read_identities
from moseg.workflows.results.shown_frames import spread

SCALE_FRAMES = 16
"""Frames, spread over the video, by which the scales of cues are settled."""


@dataclass(frozen=True)
class ShownResult:
    """One state of a result; corrections make another one, and this one stays as it is.

    Attributes
    ----------
    store : ArtifactStore
    graph : SequenceGraph
        Of the corrections in force.
    config : PipelineConfig
    variant : Variant
    live : LiveLabels
    key : str
        Name of this state: pictures of one name never change.
    name : str
    shape : (int, int)
        Height and width of the video's frames, px.
    fps : float
        Frames per second.
    """

    store: ArtifactStore
    graph: SequenceGraph
    config: PipelineConfig
    variant: Variant
    live: LiveLabels
    key: str
    name: str
    shape: tuple[int, int]
    fps: float

    @property
    def found(self) -> FoundObjects:
        """All objects, also those that are not in the result."""
        return self.live.found

    @property
    def identities(self) -> tuple[int, ...]:
        """Identities of the objects of the result."""
        return self.live.shown

    @property
    def analysed_shape(self) -> tuple[int, int]:
        """Height and width of the frames as analysed, px."""
        return self.graph.leaves.shape

    @property
    def num_frames(self) -> int:
        """Frames of the video."""
        return len(self.graph.leaves.frames)

    @property
    def view(self) -> SequenceView:
        """The sequence with the frames that settle the scales of cues."""
        return SequenceView(self.store, self.graph, self.config, spread(self.num_frames, SCALE_FRAMES))

    def image(self, frame: int) -> np.ndarray:
        """Return a frame as analysed, uint8 (y, x, 3) RGB."""
        return self.store.read(self.graph.leaves.frames[frame], "image")

    def labels(self, frame: int) -> np.ndarray:
        """Return the labels of a frame as analysed, uint16 (y, x); 0 = static, else an identity."""
        return self.live.frame(frame)

    def proposals(self, frame: int) -> np.ndarray:
        """Return all objects of a frame, moving or static, before any correction, uint16 (y, x) of identities."""
        section, row = self.graph.place(frame)
        masks = self.store.read_rows(self.graph.objects.proposals(section), "masks", row, row + 1)[0]
        return self.identity_of_masks(section)[masks]

    def identity_of_masks(self, section: int) -> np.ndarray:
        """Return the identity of each value of a section's proposals, uint16 (value,)."""
        names = np.array((0, *self.proposed), np.uint16)
        return names[self._linked_identities[section]]

    @cached_property
    def proposed(self) -> tuple[int, ...]:
        """Identities of all objects before any correction, moving or static."""
        return read_identities(self.store, self.graph)[0]

    @cached_property
    def _linked_identities(self) -> np.ndarray:
        return self.store.read(self.graph.objects.linking(), "identity")
