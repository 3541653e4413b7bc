"""Output of EM (Meunier et al. 2022): a probability per layer, or a binary mask, at the network's size."""

from pathlib import Path

import cv2
import numpy as np

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.predictions.as_labels import as_labels
from moseg.workflows.predictions.frame_files import FrameFiles
from moseg.workflows.predictions.frame_list import FrameList
from moseg.workflows.predictions.label_images import read_label_image
from moseg.workflows.sources.files import read_bytes
from moseg.workflows.sources.numpy_file import decode_array


class LayerProbabilities:
    """The most probable layer of each pixel.

    As in the authors' evaluation, probabilities are resized to the frame bilinearly and the layer that holds most
    pixels of a frame is its background. Layer i is object i + 1 in every frame.
    """

    def __init__(self, files: FrameFiles, shape: tuple[int, int]):
        self.files = files
        self.matching, self.repeats_last = files.matching, files.repeats_last
        self.shape = shape

    def frame(self, index: int) -> np.ndarray:
        """Labels of one frame, uint16 (y, x)."""
        path = self.files.path(index)
        probability = decode_array(read_bytes(str(path)), path, "layer probabilities")
        if probability.ndim != 3 or probability.dtype.kind != "f" or not probability.size:
            got = f"{probability.dtype} {probability.shape}"
            raise InputError("no layer probabilities", where=path, got=got, expected="float (layer, y, x)")
        height, width = self.shape
        with np.errstate(over="ignore", invalid="ignore"):
            probability = probability.astype(np.float32)
        resized = [cv2.resize(layer, (width, height)) for layer in probability]
        layer = np.argmax(resized, axis=0)
        background = np.bincount(layer.ravel()).argmax()
        return as_labels(np.where(layer == background, 0, layer + 1), self.shape, path)


class BinaryMasks:
    """Foreground and background, as one object; resized to the frame by the nearest pixel."""

    def __init__(self, files: FrameFiles, shape: tuple[int, int]):
        self.files = files
        self.matching, self.repeats_last = files.matching, files.repeats_last
        self.shape = shape

    def frame(self, index: int) -> np.ndarray:
        """1 in the foreground, uint16 (y, x)."""
        path = self.files.path(index)
        height, width = self.shape
        foreground = (read_label_image(path) > 0).astype(np.uint8)
        return as_labels(cv2.resize(foreground, (width, height), interpolation=cv2.INTER_NEAREST), self.shape, path)


def open_em_layers(
    folder: Path, name: str, frames: FrameList, shape: tuple[int, int]
) -> LayerProbabilities | BinaryMasks:
    """``<sequence>/*_proba.npy`` or else ``<sequence>/*_binary.png``; an absent last frame repeats the one before."""
    for pattern, reader in (("*_proba.npy", LayerProbabilities), ("*_binary.png", BinaryMasks)):
        if any(True for _ in (folder / name).glob(pattern)):
            return reader(FrameFiles([folder / name], pattern, frames, by_pairs=True), shape)
    expected = f"{folder / name / '*_proba.npy'} or {folder / name / '*_binary.png'}"
    raise MissingInputError("no predictions of the sequence", expected=expected)
