"""Opens a folder of saved masks, whatever method wrote it."""

from dataclasses import dataclass
from pathlib import Path

from moseg.schemas.errors import MissingInputError
from moseg.schemas.spelling import unknown_name
from moseg.workflows.predictions.formats import FORMATS, PredictionFormat, SequencePredictions, detect_format
from moseg.workflows.predictions.frame_list import FrameList


@dataclass(frozen=True)
class Predictions:
    """A folder of saved masks and the format they are in."""

    folder: Path
    format: PredictionFormat

    def sequence(self, name: str, frames: FrameList, shape: tuple[int, int]) -> SequencePredictions:
        """Find one sequence's masks; each frame is read when it is asked for.

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
            Where nothing is saved for the sequence; by ``frame``, where nothing is saved for that frame.
        InputError
            Where masks have another size, are damaged or are no labels, or which frames they are of cannot be told.
        """
        return self.format.open_sequence(self.folder, name, frames, shape)


def open_predictions(folder: Path, format: str | None = None) -> Predictions:
    """Open a folder of saved masks.

    Parameters
    ----------
    folder : Path
        Holds one folder or file per sequence.
    format : str, optional
        A name in ``FORMATS``; found from the names of the files where it is not given.

    Raises
    ------
    MissingInputError
        Where there is no such folder.
    InputError
        Where the format is not known, or the files fit none or several.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise MissingInputError("no such folder of predictions", where=folder)
    if format is None:
        return Predictions(folder, detect_format(folder))
    if format not in FORMATS:
        raise unknown_name("format of predictions", format, FORMATS, where="--format")
    return Predictions(folder, FORMATS[format])
