"""The formats that masks are saved in, by name, and how a folder shows which one it is in."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.predictions.em_layers import open_em_layers
from moseg.workflows.predictions.frame_list import FrameList
from moseg.workflows.predictions.label_images import open_label_images
from moseg.workflows.predictions.rigidmask import open_rigidmask
from moseg.workflows.predictions.volumes import open_volume
from moseg.workflows.sources.frame_matching import Matching


class SequencePredictions(Protocol):
    """The saved masks of one sequence.

    Attributes
    ----------
    matching : Matching
        How they were matched to the sequence's frames.
    repeats_last : bool
        The last frame has none, as of a method that looks at a frame and its next; that of the one before counts.
    """

    matching: Matching
    repeats_last: bool

    def frame(self, index: int) -> np.ndarray:
        """Labels of the sequence's frame `index`, counted from 0: uint16 (y, x), 0 = not moving, in a new array."""
        ...


class PredictionFormat(NamedTuple):
    """One format.

    Attributes
    ----------
    description : str
        Who writes it and what it looks like.
    patterns : tuple of str
        Paths, relative to the folder, at which its files lie.
    open_sequence : callable
        Of folder, sequence name, its frames and (height, width) to an object with ``frame(index)``.
    """

    name: str
    description: str
    patterns: tuple[str, ...]
    open_sequence: Callable[[Path, str, FrameList, tuple[int, int]], SequencePredictions]


_IN_ORDER_OF_DETECTION = (
    PredictionFormat(
        "rigidmask",
        "RigidMask: [seq-]<sequence>/pm-00000.pfm; all that moves is scored as one object",
        ("*/pm-*.pfm",),
        open_rigidmask,
    ),
    PredictionFormat(
        "em",
        "EM: <sequence>/00000_proba.npy (layer, y, x) or <sequence>/00000_binary.png; resized to the frames",
        ("*/*_proba.npy", "*/*_binary.png"),
        open_em_layers,
    ),
    PredictionFormat(
        "volume",
        "volumes (frame, y, x) of labels: <sequence>.npy or <sequence>.npz, as MoSeg writes",
        ("*.npy", "*.npz"),
        open_volume,
    ),
    PredictionFormat(
        "png",
        "palette or grey images of labels: <sequence>/[masks/]00000.png, or Raptor's single_mask/<sequence>/00000.png",
        ("*/*.png", "*/*/*.png"),
        open_label_images,
    ),
)

FORMATS = {entry.name: entry for entry in _IN_ORDER_OF_DETECTION}


def detect_format(folder: Path) -> PredictionFormat:
    """The first format, from the most to the least particular, whose files a folder holds.

    Raises
    ------
    InputError
        Where it holds files of none.
    """
    for entry in _IN_ORDER_OF_DETECTION:
        if any(True for pattern in entry.patterns for _ in folder.glob(pattern)):
            return entry
    patterns = [pattern for entry in _IN_ORDER_OF_DETECTION for pattern in entry.patterns]
    raise InputError("no predictions", where=folder, expected=f"files {', '.join(patterns)}")
