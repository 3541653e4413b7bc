"""A folder of saved masks: the formats that it may be in, and how its format is found."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np

from moseg.schemas.errors import InputError, MissingInputError
from moseg.schemas.spelling import unknown_name
from moseg.workflows.predictions.frame_files import FrameList
from moseg.workflows.predictions.image_formats import open_em_layers, open_label_images, open_rigidmask
from moseg.workflows.predictions.volumes import open_volume
from moseg.workflows.sources.frame_matching import Matching


class SequencePredictions(Protocol):
    """The saved masks of one sequence.

    Attributes
    ----------
    matching : Matching
        How they were matched to the sequence's frames.
    repeats_last : bool
        True if the last frame has none, as of a method that uses a frame and the next one; that of the frame before is
        used.
    """

    matching: Matching
    repeats_last: bool

    def frame(self, index: int) -> np.ndarray:
        """Return the labels of frame `index`, counted from 0: uint16 (y, x), 0 = not moving, in a new array."""
        ...


class PredictionFormat(NamedTuple):
    """One format.

    Attributes
    ----------
    name, description : str
        Value of ``--format``; who writes it and what it looks like.
    patterns : tuple of str
        Paths of its files, relative to the folder.
    open_sequence : callable
        Takes a folder, a sequence's name, its frames and its (height, width).
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


@dataclass(frozen=True)
class Predictions:
    """A folder of saved masks and the format they are in."""

    folder: Path
    format: PredictionFormat

    def sequence(self, name: str, frames: FrameList, shape: tuple[int, int]) -> SequencePredictions:
        """Find the masks of one sequence; each frame is read on request.

        Parameters
        ----------
        name : str
            The sequence's name in the data set.
        frames : FrameList
            Frames of the sequence, annotated or not.
        shape : (int, int)
            Height and width of the ground truth, px.

        Raises
        ------
        MissingInputError
            Nothing is saved for the sequence; by ``frame``, nothing is saved for that frame.
        InputError
            Masks have another size, are damaged or are not labels, or their frames cannot be determined.
        """
        return self.format.open_sequence(self.folder, name, frames, shape)


def open_predictions(folder: Path, format: str | None = None) -> Predictions:
    """Open a folder of saved masks.

    Parameters
    ----------
    folder : Path
        Holds one folder or file per sequence.
    format : str, optional
        A name in `FORMATS`; found from the names of the files if it is not given: the first format, from the most to
        the least particular, that has files there.

    Raises
    ------
    MissingInputError
        There is no such folder.
    InputError
        The format is not known, or the folder holds no files of any format.
    """
    folder = Path(folder)
    if not os.path.isdir(folder):
        raise MissingInputError("no such folder of predictions", where=folder)
    if format is not None:
        if format not in FORMATS:
            raise unknown_name("format of predictions", format, FORMATS, where="--format")
        return Predictions(folder, FORMATS[format])
    for entry in _IN_ORDER_OF_DETECTION:
        if any(True for pattern in entry.patterns for _ in folder.glob(pattern)):
            return Predictions(folder, entry)
    patterns = [pattern for entry in _IN_ORDER_OF_DETECTION for pattern in entry.patterns]
    raise InputError("no predictions", where=folder, expected=f"files {', '.join(patterns)}")
