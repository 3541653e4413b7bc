"""Masks from PNG files."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from typing import Literal, Protocol

import numpy as np
from PIL import ImageMode

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.workflows.sources.files import digest_file, read_bytes
from moseg.workflows.sources.png_file import decode_label_png

MaskKind = Literal["binary", "instance"]
MASK_SUFFIXES = (".png",)
DECODING_VERSION = 1
"""Raised when `MaskFiles.read` starts to yield other labels for the same bytes."""


class MaskSource(Protocol):
    """Labels of some frames of a sequence."""

    def fingerprint(self) -> str:
        """Return the digest of everything on which `read` depends."""

    def read(self) -> Iterator[tuple[int, np.ndarray]]:
        """Yield the index of a frame and its uint16 (y, x) labels, 0 = background."""


@dataclass(frozen=True)
class MaskFiles:
    """Mask files and the frames they belong to.

    Attributes
    ----------
    items : tuple of (int, str)
        Index of the frame and path of its mask, in order of the frames.
    kind : 'binary' or 'instance'
        Any non-zero value is label 1, or values are labels unchanged (255 stays 255, the usual void label).
    size : (int, int), optional
        (height, width) px that every mask must have, that of the original frames; the first mask's where None.
    """

    items: tuple[tuple[int, str], ...]
    kind: MaskKind
    size: tuple[int, int] | None = None

    def __post_init__(self):
        if not self.items:
            raise InputError("no masks", got="an empty list of mask files")

    def fingerprint(self) -> str:
        """Return the digest of the files' bytes, the frames they belong to and the decode parameters."""
        files = [[index, digest_file(path)] for index, path in self.items]
        return digest_json("source", ["masks", DECODING_VERSION, self.kind, self.size, files])

    def read(self) -> Iterator[tuple[int, np.ndarray]]:
        """Yield frame index and uint16 (y, x) labels; raise InputError for a file that cannot be a mask."""
        size = self.size
        for index, path in self.items:
            labels = decode_mask(read_bytes(path), path, self.kind)
            size = size or labels.shape
            if labels.shape != size:
                raise InputError(
                    "mask of the wrong size",
                    where=path,
                    got=f"{labels.shape[1]}x{labels.shape[0]} px",
                    expected=f"{size[1]}x{size[0]} px as its frame",
                )
            yield index, labels


def decode_mask(content: bytes, path: str, kind: MaskKind) -> np.ndarray:
    """Return the labels of one mask file.

    A palette image gives its indices, not its colours; alpha is ignored. A colour image gives its grey values if the
    three channels agree; if they differ it can still be a binary mask, but holds no object ids.

    Returns
    -------
    uint16 (y, x)

    Raises
    ------
    InputError
        Not an image, cut short, colours instead of ids, or ids beyond 65535.
    """
    mode, values = decode_label_png(content, path, "mask")
    values = np.atleast_3d(values)
    channels = [values[..., i] for i, band in enumerate(ImageMode.getmode(mode).bands) if band != "A"]
    if kind == "binary":
        return reduce(np.logical_or, channels).astype(bool).astype(np.uint16)
    labels = channels[0]
    if any(not np.array_equal(labels, other) for other in channels[1:]):
        raise InputError("mask of colours", where=path, expected="object ids (a palette or grey PNG)")
    if labels.dtype.kind == "f" or labels.min() < 0 or labels.max() > np.iinfo(np.uint16).max:
        raise InputError("mask of unusable ids", where=path, got=labels.dtype, expected="integers of 0 to 65535")
    return labels.astype(np.uint16)


def find_mask_kind(paths: tuple[str, ...]) -> MaskKind:
    """Return 'binary' if all masks hold only 0 and 255, else 'instance'.

    Editors write 255 alone for "object"; together with other ids it is the void label.
    """
    for path in paths:
        content = read_bytes(path)
        labels = np.unique(decode_mask(content, path, "instance"))
        if not np.isin(labels, (0, 255)).all():
            return "instance"
    return "binary"
