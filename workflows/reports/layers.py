"""Layers of a sequence: which artifacts they need, the size and colours of their pictures, and their encoding."""

import io
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from PIL import Image

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.exports.palette import identity_colours
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.content import Layer, LegendEntry, Picture
from moseg.workflows.reports.missing import AbsentPart, name_absent
from moseg.workflows.results.found_objects import FoundObjects
from moseg.workflows.sources.resize import working_size

PICTURE_SIDE = 480
"""Longer side of a picture, px."""
QUALITY = 80
"""Quality of lossy pictures, 0..100: the loss is not visible at the size of a report."""


class SequenceView(NamedTuple):
    """A sequence and its shown frames; `store` is None where only references are asked for."""

    store: ArtifactStore | None
    graph: SequenceGraph
    config: PipelineConfig
    frames: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width of the pictures, px."""
        return working_size(self.graph.leaves.shape, PICTURE_SIDE)

    def sections(self, frames: Iterable[int] | None = None) -> list[int]:
        """Return the sections of some frames, by default of the shown ones, each once."""
        return sorted({self.graph.place(frame)[0] for frame in (self.frames if frames is None else frames)})

    def label_refs(self, variant: Variant, frames: Iterable[int] | None = None) -> tuple[str, ...]:
        """Return the references of the labels of some frames, by default of the shown ones, each once."""
        segmentations = self.graph.segmentations(variant)
        return tuple(segmentations[section] for section in self.sections(frames))

    def labels(self, variant: Variant, frame: int) -> np.ndarray:
        """Return the labels of one frame as analysed, uint16 (y, x); 0 = static, else an identity."""
        section, row = self.graph.place(frame)
        return self.store.read_rows(self.graph.segmentations(variant)[section], "labels", row, row + 1)[0]


class PlannedLayer(NamedTuple):
    """A layer's name, the references that it reads, and the function that makes it."""

    name: str
    refs: tuple[str, ...]
    make: Callable[[], Layer]


def make_layers(
    store: ArtifactStore, planned: Sequence[PlannedLayer]
) -> tuple[tuple[Layer, ...], tuple[AbsentPart, ...]]:
    """Return the layers whose artifacts are all in the store, and the parts that lack some."""
    present = store.present({ref for plan in planned for ref in plan.refs})
    layers, missing = [], []
    for plan in planned:
        absent = set(plan.refs) - present
        if absent:
            missing.append(name_absent(plan.name, absent))
        else:
            layers.append(plan.make())
    return tuple(layers), tuple(missing)


def merge_layers(layers: Iterable[Layer]) -> tuple[Layer, ...]:
    """Merge layers of several variants that have the same pictures, under all their names, in the place of the first.

    Names that end with a variant in brackets are those of one kind of layer.
    """
    merged: list[tuple[Layer, list[str]]] = []
    for layer in layers:
        kind, _, variant = layer.name.removesuffix(")").partition(" (")
        equal = next(
            (
                variants
                for other, variants in merged
                if variant and other.name.startswith(f"{kind} (")
                if (other.pictures, other.legend) == (layer.pictures, layer.legend)
            ),
            None,
        )
        if equal is None:
            merged.append((layer, [variant]))
        else:
            equal.append(variant)
    return tuple(
        layer if len(variants) == 1 else layer._replace(name=f"{layer.name.partition(' (')[0]} ({', '.join(variants)})")
        for layer, variants in merged
    )


def encode_opaque(image: np.ndarray) -> Picture:
    """Return uint8 (y, x, rgb) as a lossy WebP."""
    return _encode(image, quality=QUALITY)


def encode_transparent(image: np.ndarray) -> Picture:
    """Return uint8 (y, x, rgba) as a lossless WebP."""
    return _encode(image, lossless=True)


@cache
def all_colours() -> np.ndarray:
    """Return the colour of each identity in the overlay, uint8 (2 ** 16, rgb), read-only; 0 is black."""
    colours = identity_colours(np.arange(2**16))
    colours.flags.writeable = False
    return colours


def as_hex(colour: Iterable[int]) -> str:
    """Return an RGB colour as ``#rrggbb``."""
    return "#" + "".join(f"{int(level):02x}" for level in colour)


def object_legend(found: FoundObjects, is_moving_only: bool) -> tuple[LegendEntry, ...]:
    """Return the colours of objects, and their identity, name and motion."""
    colours = all_colours()
    return tuple(
        LegendEntry(as_hex(colours[identity]), _describe(identity, motion, found.called))
        for identity, motion in found.motions.items()
        if motion or not is_moving_only
    )


def _describe(identity: int, motion: int, names: dict[int, str]) -> str:
    name = f" ({names[identity]})" if identity in names else ""
    return f"object {identity}{name}, " + (f"motion {motion}" if motion else "static")


def _encode(image: np.ndarray, **options) -> Picture:
    stream = io.BytesIO()
    Image.fromarray(image).save(stream, format="WebP", **options)
    height, width = image.shape[:2]
    return Picture("image/webp", stream.getvalue(), width, height)
