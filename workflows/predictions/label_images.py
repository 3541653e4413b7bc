"""Label images: palette, grey or 16-bit PNG, one per frame."""

import io
from pathlib import Path

import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.predictions.as_labels import as_labels
from moseg.workflows.predictions.frame_files import FrameFiles
from moseg.workflows.predictions.frame_list import FrameList
from moseg.workflows.sources.files import read_bytes
from moseg.workflows.sources.pillow_image import PILLOW_ERRORS, open_quietly
from moseg.workflows.sources.png_file import check_png_data, check_png_size

# Pillow's modes of one channel; of a palette image the array is the index, not the colour.
_LABEL_MODES = {"1", "L", "P", "I", "I;16"}


class LabelImages:
    """The label images of one sequence."""

    def __init__(self, files: FrameFiles, shape: tuple[int, int]):
        self.files = files
        self.matching, self.repeats_last = files.matching, files.repeats_last
        self.shape = shape

    def frame(self, index: int) -> np.ndarray:
        """Labels of one frame, uint16 (y, x)."""
        path = self.files.path(index)
        return as_labels(read_label_image(path), self.shape, path)


def open_label_images(folder: Path, name: str, frames: FrameList, shape: tuple[int, int]) -> LabelImages:
    """Label images in ``<sequence>/``, ``<sequence>/masks/`` or, as Raptor writes, ``single_mask/<sequence>/``.

    Raptor numbers the objects of each frame downwards from their count, so an object's label changes where that
    count does. Labels are taken as they are written.
    """
    folders = [folder / name, folder / name / "masks", folder / "single_mask" / name, folder / name / "single_mask"]
    return LabelImages(FrameFiles(folders, "*.png", frames), shape)


def read_label_image(path: Path) -> np.ndarray:
    """Values of a one-channel PNG, palette indices included: bool or integer (y, x).

    Raises
    ------
    InputError
        Where the file is no image or has colours in place of labels.
    """
    content = read_bytes(str(path))
    check_png_size(content, path, "label image")
    check_png_data(content, path, "label image")
    try:
        with open_quietly(io.BytesIO(content)) as image:
            image.load()
            mode, values = image.mode, np.asarray(image)
    except PILLOW_ERRORS as error:
        # Pillow names the stream where it cannot identify an image.
        raise InputError("label image cannot be decoded", where=path, got=f"{len(content)} bytes") from error
    if mode not in _LABEL_MODES:
        raise InputError("colours in place of labels", where=path, got=mode, expected="a palette or grey image")
    return values
