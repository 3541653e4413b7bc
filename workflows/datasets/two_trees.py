"""DAVIS and YouTube-VOS: one tree of frames and one of annotations, with a folder for each sequence."""

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.datasets.dataset import SequenceSource
from moseg.workflows.datasets.sequence_folders import annotated_sequence, list_sequences

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

    def __post_init__(self):
        """Raise InputError if an attribute is of another kind, as one of a plug-in may be."""
        for name, is_right, expected in (
            ("kind", self.kind in ("binary", "instance"), "'binary' or 'instance'"),
            ("void", self.void is None or type(self.void) is int, "a label, or None"),
            ("official", self.official is None or type(self.official) in (tuple, list), "names in a tuple, or None"),
        ):
            if not is_right:
                got = repr(getattr(self, name))
                raise InputError(f"wrong {name}", where=f"data set {self.name}", got=got, expected=expected)

    @property
    def tree(self) -> str:
        """Return the expected files below the root."""
        listing = f", and {self.list_name} with one sequence per line" if self.list_name else ""
        return f"{self.frames}/<sequence>/*.jpg and {self.masks}/<sequence>/*.png{listing}"

    def on_disk(self, root: str) -> tuple[str, ...]:
        """Return the folders of the tree of frames that hold images."""
        tree = os.path.join(root, self.frames)
        if not os.path.isdir(tree):
            raise MissingInputError(f"no {self.name} below its root", where=tree, expected=self.tree)
        return list_sequences(tree, ("",))

    def open_sequence(self, root: str, name: str, max_side: int) -> SequenceSource:
        """Return the sources of one sequence."""
        frames, masks = os.path.join(root, self.frames, name), os.path.join(root, self.masks, name)
        return annotated_sequence(name, frames, masks, self.kind, self.void, max_side)


_DAVIS16_VALIDATION = """
blackswan bmx-trees breakdance camel car-roundabout car-shadow cows dance-twirl dog drift-chicane drift-straight goat
horsejump-high kite-surf libby motocross-jump paragliding-launch parkour scooter-black soapbox
"""
"""ImageSets/480p/val.txt of the data set."""
_DAVIS_MOVING_VALIDATION = """
bike-packing blackswan bmx-trees car-shadow cows dance-twirl dog dogs-jump drift-chicane drift-straight goat
horsejump-high judo kite-surf libby mbike-trick motocross-jump paragliding-launch parkour pigs shooting soapbox
"""
"""Sequences of DAVIS-2017 val in the list of Dave et al."""

DAVIS16 = TwoTrees(
    name="davis16",
    frames="JPEGImages/480p",
    masks="Annotations/480p",
    kind="binary",
    void=None,
    official=tuple(_DAVIS16_VALIDATION.split()),
    list_name=None,
    ground_truth="binary masks, every frame",
    source="DAVIS 2016, 480p, from https://davischallenge.org/davis2016/code.html",
)
"""DAVIS-2016 (Perazzi et al. 2016): one foreground per sequence, binary."""

DAVIS_MOVING = TwoTrees(
    name="davis-moving",
    frames="JPEGImages/480p",
    masks="Annotations/480p",
    kind="instance",
    void=255,
    official=tuple(_DAVIS_MOVING_VALIDATION.split()),
    list_name=None,
    ground_truth="instance masks, every frame; 255 is void",
    source="DAVIS 2017 TrainVal, 480p, from https://davischallenge.org/davis2017/code.html",
)
"""DAVIS-Moving (Dave et al. 2019): sequences of DAVIS-2017 in which every labelled object moves and no other does."""

YTVOS_MOVING = TwoTrees(
    name="ytvos-moving",
    frames="JPEGImages",
    masks="Annotations",
    kind="instance",
    void=None,
    official=None,
    list_name="moving_val.txt",
    ground_truth="instance masks, every 5th frame",
    source=(
        "YouTube-VOS 2018 train from https://youtube-vos.org, and the list of validation sequences from "
        "https://github.com/achalddave/segment-any-moving"
    ),
)
"""YTVOS-Moving (Dave et al. 2019): sequences of YouTube-VOS in which every labelled object moves and no other does.

The 101 validation sequences are drawn from YouTube-VOS's training part. Their list belongs to its authors; the user
provides it.
"""
