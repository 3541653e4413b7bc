"""A sequence as its pictures see it: where things lie in the store, and the size at which they are drawn."""

from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.exports.draw_labels import brightest
from moseg.workflows.exports.palette import identity_colours
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.picture_content import LegendEntry
from moseg.workflows.results.found_objects import FoundObjects
from moseg.workflows.sources.resize import working_size

PICTURE_SIDE = 480
"""Longer side of a picture, px."""


class SequenceView(NamedTuple):
    """A sequence, and the frames of it that are shown; `store` is None where only references are asked for."""

    store: ArtifactStore | None
    graph: SequenceGraph
    config: PipelineConfig
    frames: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of the pictures, px."""
        return working_size(self.graph.leaves.shape, PICTURE_SIDE)

    def place(self, frame: int) -> tuple[int, int]:
        """The section that a frame belongs to, and its row there."""
        return divmod(frame, self.config.sections.length)

    def label_refs(self, variant: Variant, frames: Iterable[int]) -> tuple[str, ...]:
        """References of the labels of some frames, each once."""
        segmentations = self.graph.segmentations(variant)
        return tuple(segmentations[section] for section in sorted({self.place(frame)[0] for frame in frames}))

    def labels(self, variant: Variant, frame: int) -> np.ndarray:
        """Labels of one frame as analysed, uint16 (y, x); 0 = static, else an identity."""
        section, row = self.place(frame)
        return self.store.read_rows(self.graph.segmentations(variant)[section], "labels", row, row + 1)[0]


@cache
def all_tints() -> np.ndarray:
    """Colour of what each identity's outline encloses in the overlay, uint8 (2 ** 16, rgb), read-only; 0 is black."""
    tints = identity_colours(np.arange(2**16))
    tints.flags.writeable = False
    return tints


@cache
def all_colours() -> np.ndarray:
    """Colour of each identity's outline in the overlay, uint8 (2 ** 16, rgb), read-only; that of 0 is black."""
    colours = brightest(all_tints())
    colours.flags.writeable = False
    return colours


def as_hex(colour: Iterable[int]) -> str:
    """An RGB colour as ``#rrggbb``."""
    return "#" + "".join(f"{int(level):02x}" for level in colour)


def list_identities(found: FoundObjects, is_moving_only: bool) -> tuple[LegendEntry, ...]:
    """Colours of objects and what they are."""
    colours = all_colours()
    return tuple(
        LegendEntry(as_hex(colours[identity]), _describe(identity, motion, found.tags))
        for identity, motion in found.motions.items()
        if motion or not is_moving_only
    )


def _describe(identity: int, motion: int, tags: dict[int, str]) -> str:
    tag = f" ({tags[identity]})" if identity in tags else ""
    return f"object {identity}{tag}, " + (f"motion {motion}" if motion else "static")
