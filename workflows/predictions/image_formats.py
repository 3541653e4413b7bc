"""Formats of one file per frame: label images, RigidMask's float maps, EM's layers and masks."""

import io
from functools import partial
from pathlib import Path

import cv2
import numpy as np

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.predictions.frame_files import FrameFiles, FrameList
from moseg.workflows.sources.files import read_bytes
from moseg.workflows.sources.numpy_file import decode_array
from moseg.workflows.sources.png_file import decode_label_png

# Pillow's modes of one channel; the array of a palette image holds the indices, not the colours.
_LABEL_MODES = {"1", "L", "P", "I", "I;16"}


def open_label_images(folder: Path, name: str, frames: FrameList, shape: tuple[int, int]) -> FrameFiles:
    """Find label images in ``<sequence>/``, ``<sequence>/masks/`` or, as Raptor writes, ``single_mask/<sequence>/``.

    Raptor numbers the objects of each frame downwards from their count, so an object's label changes if that count
    does. Labels are taken as they are written.
    """
    folders = [folder / name, folder / name / "masks", folder / "single_mask" / name, folder / name / "single_mask"]
    return FrameFiles(folders, "*.png", frames, shape, _read_label_image)


def open_rigidmask(folder: Path, name: str, frames: FrameList, shape: tuple[int, int]) -> FrameFiles:
    """Find ``<sequence>/pm-*.pfm`` or ``seq-<sequence>/pm-*.pfm``; a missing last frame repeats the one before.

    RigidMask numbers the rigid bodies of each frame anew, so its labels do not identify a body over time. A link
    between frames would be this project's and not the method's: all that moves is object 1.
    """
    folders = [folder / name, folder / f"seq-{name}"]
    return FrameFiles(folders, "pm-*.pfm", frames, shape, lambda path: _read_pfm(path) > 0, by_pairs=True)


def open_em_layers(folder: Path, name: str, frames: FrameList, shape: tuple[int, int]) -> FrameFiles:
    """Find the output of EM (Meunier et al. 2022): a probability per layer or a binary mask, at the network's size.

    These are ``<sequence>/*_proba.npy`` or else ``<sequence>/*_binary.png``. A missing last frame repeats the one
    before.
    """
    for pattern, read in (("*_proba.npy", _read_layers), ("*_binary.png", _read_binary)):
        if any(True for _ in (folder / name).glob(pattern)):
            return FrameFiles([folder / name], pattern, frames, shape, partial(read, shape=shape), by_pairs=True)
    expected = f"{folder / name / '*_proba.npy'} or {folder / name / '*_binary.png'}"
    raise MissingInputError("no predictions of the sequence", expected=expected)


def _read_label_image(path: Path) -> np.ndarray:
    """Return the values of a one-channel PNG, palette indices included: bool or integer (y, x)."""
    mode, values = decode_label_png(read_bytes(str(path)), path, "label image")
    if mode not in _LABEL_MODES:
        raise InputError("colours in place of labels", where=path, got=mode, expected="a palette or grey image")
    return values


def _read_layers(path: Path, shape: tuple[int, int]) -> np.ndarray:
    """Return the most probable layer of each pixel, (y, x).

    As in the authors' evaluation, probabilities are resized to the frame bilinearly and the layer that holds most
    pixels of a frame is its background. Layer i is object i + 1 in every frame.
    """
    probability = decode_array(read_bytes(str(path)), path, "layer probabilities")
    if probability.ndim != 3 or probability.dtype.kind != "f" or not probability.size:
        got = f"{probability.dtype} {probability.shape}"
        raise InputError("no layer probabilities", where=path, got=got, expected="float (layer, y, x)")
    height, width = shape
    with np.errstate(over="ignore", invalid="ignore"):
        probability = probability.astype(np.float32)
    if not np.isfinite(probability).all():
        raise InputError("no layer probabilities", where=path, got="NaN or infinite values", expected="finite values")
    resized = [cv2.resize(layer, (width, height)) for layer in probability]
    layer = np.argmax(resized, axis=0)
    background = np.bincount(layer.ravel()).argmax()
    return np.where(layer == background, 0, layer + 1)


def _read_binary(path: Path, shape: tuple[int, int]) -> np.ndarray:
    """Return foreground and background as one object, resized to the frame by the nearest pixel."""
    height, width = shape
    foreground = (_read_label_image(path) > 0).astype(np.uint8)
    return cv2.resize(foreground, (width, height), interpolation=cv2.INTER_NEAREST)


def _read_pfm(path: Path) -> np.ndarray:
    """Return a grey portable float map, float32 (y, x), top row first.

    The file has three lines of text, ``Pf``, width and height, and a scale whose sign is the byte order (negative is
    little-endian); then the rows from the bottom up.
    """
    content = io.BytesIO(read_bytes(str(path)))
    kind, size, scale = (content.readline(64).strip() for _ in range(3))
    data = content.read()
    try:
        width, height = map(int, size.split())
        order = "<" if float(scale) < 0 else ">"
    except ValueError as error:
        raise InputError("no portable float map", where=path, got=size + b" " + scale) from error
    if kind != b"Pf" or min(width, height) < 1:
        raise InputError("no grey portable float map", where=path, got=kind.decode("latin-1"), expected="Pf")
    if len(data) != 4 * width * height:
        raise InputError("cut-off float map", where=path, got=f"{len(data)} bytes", expected=4 * width * height)
    return np.frombuffer(data, dtype=f"{order}f4").reshape(height, width)[::-1].astype(np.float32)
