"""Layers that are made only where the store still holds all that they show."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from moseg.store import ArtifactStore
from moseg.workflows.reports.missing import AbsentPart, name_absent
from moseg.workflows.reports.picture_content import Layer, Video
from moseg.workflows.reports.table_content import ObjectRow


class PlannedLayer(NamedTuple):
    """A layer's name, the references that it reads, and what makes it."""

    name: str
    refs: tuple[str, ...]
    make: Callable[[], Layer]


class SequencePictures(NamedTuple):
    """What a report shows of a sequence or clip besides matrices; the fields are those of `SequencePanel`."""

    num_frames: int
    shape: tuple[int, int]
    frames: tuple[int, ...]
    layers: tuple[Layer, ...]
    objects: tuple[ObjectRow, ...] = ()
    video: Video | None = None
    missing: tuple[str, ...] = ()


def make_layers(
    store: ArtifactStore, planned: Sequence[PlannedLayer]
) -> tuple[tuple[Layer, ...], tuple[AbsentPart, ...]]:
    """The layers that can be made, and those that cannot."""
    present = store.present({ref for plan in planned for ref in plan.refs})
    layers, missing = [], []
    for plan in planned:
        absent = set(plan.refs) - present
        if absent:
            missing.append(name_absent(plan.name, absent))
        else:
            layers.append(plan.make())
    return tuple(layers), tuple(missing)
