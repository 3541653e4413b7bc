"""Layout of DAVIS and YouTube-VOS: one tree of frames and one of annotations, a folder a sequence in each."""

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from moseg.schemas.errors import MissingInputError
from moseg.workflows.datasets.annotated import annotated_sequence
from moseg.workflows.datasets.dataset import SequenceSource
from moseg.workflows.datasets.sequence_folders import list_sequences

if TYPE_CHECKING:
    from moseg.workflows.sources import MaskKind


@dataclass(frozen=True)
class TwoTrees:
    """``<root>/<frames>/<sequence>/*.jpg`` and ``<root>/<masks>/<sequence>/*.png``, matched by stem."""

    name: str
    frames: str
    masks: str
    kind: "MaskKind"
    void: int | None
    official: tuple[str, ...] | None
    list_name: str | None
    ground_truth: str
    source: str
    needs_root: bool = True

    @property
    def tree(self) -> str:
        """The expected files below the root."""
        listing = f", and {self.list_name} with one sequence a line" if self.list_name else ""
        return f"{self.frames}/<sequence>/*.jpg and {self.masks}/<sequence>/*.png{listing}"

    def on_disk(self, root: str) -> tuple[str, ...]:
        """Folders of the tree of frames that hold images."""
        tree = os.path.join(root, self.frames)
        if not os.path.isdir(tree):
            raise MissingInputError(f"no {self.name} below its root", where=tree, expected=self.tree)
        return list_sequences(tree, ("",))

    def open_sequence(self, root: str, name: str, max_side: int) -> SequenceSource:
        """The sources of one sequence."""
        frames, masks = os.path.join(root, self.frames, name), os.path.join(root, self.masks, name)
        return annotated_sequence(name, frames, masks, self.kind, self.void, max_side)
