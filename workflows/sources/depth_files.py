"""Relative inverse depth from files, one per frame."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.workflows.sources.files import digest_file, read_bytes
from moseg.workflows.sources.numpy_file import decode_array
from moseg.workflows.sources.png_file import decode_png
from moseg.workflows.sources.resize import shrink_to, working_size

DEPTH_SUFFIXES = (".npy", ".png")
DECODING_VERSION = 1
"""Raised when `DepthFiles.read` starts to yield other values for the same bytes."""


@dataclass(frozen=True)
class DepthFiles:
    """Maps of relative inverse depth (larger is nearer), one per frame, in order.

    Attributes
    ----------
    paths : tuple of str
        ``.npy`` of floats (y, x), or 16-bit grey PNG, whose range becomes 0..1.
    size : (int, int)
        Original (height, width) of the frames, px. Maps have it, or the size at which the frames are analysed.
    max_side : int
        As the frames': maps of the original size are area-resized with them.
    """

    paths: tuple[str, ...]
    size: tuple[int, int]
    max_side: int

    def fingerprint(self) -> str:
        """Return the digest of the files' bytes and the decode parameters."""
        files = [digest_file(path) for path in self.paths]
        return digest_json("source", ["depth", DECODING_VERSION, self.size, self.max_side, files])

    def read(self) -> Iterator[np.ndarray]:
        """Yield each map as float32 (y, x) at the frames' working size; raise InputError for an unusable file."""
        reduced = working_size(self.size, self.max_side)
        for path in self.paths:
            depth = decode_depth(read_bytes(path), path)
            if depth.shape not in (self.size, reduced):
                raise InputError(
                    "depth map of the wrong size",
                    where=path,
                    got=f"{depth.shape[1]}x{depth.shape[0]} px",
                    expected=f"{self.size[1]}x{self.size[0]} px as its frame",
                )
            yield shrink_to(depth, reduced)


def decode_depth(content: bytes, path: str) -> np.ndarray:
    """Return float32 (y, x) of a ``.npy`` or 16-bit PNG file; raise InputError unless it is a finite map."""
    if path.lower().endswith(".npy"):
        depth = _decode_npy(content, path)
    else:
        depth = _decode_png(content, path)
    if num_bad := int(np.count_nonzero(~np.isfinite(depth))):
        raise InputError("depth map is not finite", where=path, got=f"{num_bad} NaN or infinite values")
    return depth


def _decode_npy(content: bytes, path: str) -> np.ndarray:
    depth = decode_array(content, path, "depth map")
    if depth.ndim != 2 or depth.dtype.kind != "f":
        got = f"{depth.dtype} of shape {depth.shape}"
        raise InputError("not a depth map", where=path, got=got, expected="floats (y, x)")
    # Values beyond float32 become infinite here and are reported like NaN.
    with np.errstate(over="ignore", invalid="ignore"):
        return depth.astype(np.float32)


def _decode_png(content: bytes, path: str) -> np.ndarray:
    image = decode_png(content, path, "depth map")
    if image.ndim != 2 or image.dtype != np.uint16:
        got = f"{image.dtype} of shape {image.shape}"
        raise InputError("not a depth map", where=path, got=got, expected="16-bit grey PNG")
    return image.astype(np.float32) / np.float32(65535)
