"""Optical flow from files, one per frame pair."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.workflows.sources.files import digest_file, read_bytes
from moseg.workflows.sources.numpy_file import decode_array
from moseg.workflows.sources.png_file import decode_png
from moseg.workflows.sources.resize import shrink_to, working_size

FLOW_SUFFIXES = (".flo", ".npy", ".png")
DECODING_VERSION = 1
"""Raised when `FlowFiles.read` starts to yield other values for the same bytes."""

_FLO_HEADER = struct.Struct("<4sii")  # tag, width, height
_FLO_TAG = b"PIEH"
_FLO_UNKNOWN = 1e9  # px/frame; Middlebury calls longer vectors unknown
_KITTI_ZERO, _KITTI_STEPS = 2**15, 64  # stored value of no motion; steps per px/frame
_MIN_KNOWN = 0.5  # share of the area under a reduced pixel that must be known


@dataclass(frozen=True)
class FlowFiles:
    """Flow fields of consecutive frame pairs, in order, all in one direction.

    Attributes
    ----------
    paths : tuple of str
        Middlebury ``.flo``, KITTI's 16-bit PNG (u, v, valid), or ``.npy`` of floats (y, x, uv); px/frame.
    size : (int, int)
        Original (height, width) of the frames, px. Fields have it, or the size at which the frames are analysed.
    max_side : int
        As the frames': fields of the original size are area-resized with them, and their vectors scaled.
    """

    paths: tuple[str, ...]
    size: tuple[int, int]
    max_side: int

    def fingerprint(self) -> str:
        """Return the digest of the files' bytes and the decode parameters."""
        files = [digest_file(path) for path in self.paths]
        return digest_json("source", ["flow", DECODING_VERSION, self.size, self.max_side, files])

    def read(self) -> Iterator[np.ndarray]:
        """Yield each field as float32 (y, x, 2) at the frames' working size, px/frame of it; NaN where unknown.

        Raises
        ------
        InputError
            A file cannot be used; the message names it.
        """
        reduced = working_size(self.size, self.max_side)
        for path in self.paths:
            flow = decode_flow(read_bytes(path), path)
            if flow.shape[:2] not in (self.size, reduced):
                raise InputError(
                    "flow of the wrong size",
                    where=path,
                    got=f"{flow.shape[1]}x{flow.shape[0]} px",
                    expected=f"{self.size[1]}x{self.size[0]} px as its frames",
                )
            yield shrink_flow(flow, reduced)


def shrink_flow(flow: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Return flow averaged over the known pixels of each new pixel's area, at (height, width) `size`, px/frame of it.

    A pixel is unknown (NaN) if less than half of its area is known.
    """
    if flow.shape[:2] == size:
        return flow
    known = np.isfinite(flow).all(axis=-1)
    share = shrink_to(known.astype(np.float32), size)
    average = shrink_to(np.where(known[..., None], flow, 0), size) / np.maximum(share, _MIN_KNOWN)[..., None]
    average *= np.array([size[1] / flow.shape[1], size[0] / flow.shape[0]], np.float32)
    return _without(average, share < _MIN_KNOWN)


def decode_flow(content: bytes, path: str) -> np.ndarray:
    """Return the flow of one file, whose suffix gives the format.

    Returns
    -------
    float32 (y, x, 2)
        uv, px/frame; NaN where KITTI's third channel is 0, or where a ``.flo`` has NaN or a component beyond 1e9.

    Raises
    ------
    InputError
        Not a flow, cut short, without any known pixel, or a ``.npy`` with values that are not finite.
    """
    suffix = path[-4:].lower()
    flow = {".flo": _decode_flo, ".npy": _decode_npy, ".png": _decode_kitti}[suffix](content, path)
    if not np.isfinite(flow).all(axis=-1).any():
        raise InputError("flow without a known pixel", where=path)
    return flow


def _decode_flo(content: bytes, path: str) -> np.ndarray:
    expected = "Middlebury's .flo: PIEH, width, height, then u and v of each pixel"
    if len(content) < _FLO_HEADER.size or not content.startswith(_FLO_TAG):
        raise InputError("not a flow", where=path, got=f"{len(content)} bytes", expected=expected)
    _, width, height = _FLO_HEADER.unpack_from(content)
    if width < 1 or height < 1 or len(content) != _FLO_HEADER.size + 8 * width * height:
        got = f"{len(content)} bytes for {width}x{height} px"
        raise InputError("flow cannot be decoded", where=path, got=got, expected=expected)
    flow = np.frombuffer(content, "<f4", offset=_FLO_HEADER.size).reshape(height, width, 2).astype(np.float32)
    return _without(flow, ~(np.abs(flow) <= _FLO_UNKNOWN).all(axis=-1))


def _decode_kitti(content: bytes, path: str) -> np.ndarray:
    image = decode_png(content, path, "flow")
    if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint16:
        got = f"{image.dtype} of shape {image.shape}"
        raise InputError("not a flow", where=path, got=got, expected="KITTI's 16-bit PNG of u, v and valid")
    # OpenCV reverses the file's channels u, v, valid.
    flow = (image[..., :0:-1].astype(np.float32) - _KITTI_ZERO) / _KITTI_STEPS
    return _without(flow, image[..., 0] == 0)


def _decode_npy(content: bytes, path: str) -> np.ndarray:
    flow = decode_array(content, path, "flow")
    if flow.ndim != 3 or flow.shape[2] != 2 or flow.dtype.kind != "f":
        got = f"{flow.dtype} of shape {flow.shape}"
        raise InputError("not a flow", where=path, got=got, expected="floats (y, x, 2)")
    # Values beyond float32 become infinite here and are reported like NaN.
    with np.errstate(over="ignore", invalid="ignore"):
        flow = np.array(flow, np.float32, order="C")
    if num_bad := int(np.count_nonzero(~np.isfinite(flow))):
        raise InputError("flow is not finite", where=path, got=f"{num_bad} NaN or infinite values")
    return flow


def _without(flow: np.ndarray, unknown: np.ndarray) -> np.ndarray:
    # The same NaN everywhere, because leaves are named by their bytes.
    return np.where(unknown[..., None], np.float32(np.nan), flow)
