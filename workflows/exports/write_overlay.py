"""Video with its moving objects drawn in: H.264 in MP4, which browsers play."""

import tempfile
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from itertools import zip_longest
from pathlib import Path

import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.exports.draw_overlay import NO_NAMES, draw_overlay
from moseg.workflows.exports.encode_video import Encoding, encode_video
from moseg.workflows.exports.overlay_style import DEFAULT_STYLE, OverlayStyle
from moseg.workflows.sources.resize import resize_labels, shrink_to, working_size

VISUALLY_LOSSLESS = 18
"""Constant rate factor of x264, whose scale runs from 0, lossless, to 51; its authors call 18 visually lossless."""
PRESET = "superfast"
"""Search of x264: a quarter of the time of its default, at the same size of file and 1 dB more error (DAVIS, 480p)."""
H264 = Encoding("H.264", "libx264", "mp4", "yuv420p", muxer_options={"movflags": "+faststart"})


def write_overlay(
    path: Path,
    frames: Iterable[np.ndarray],
    labels: Iterable[np.ndarray],
    fps: float | Fraction,
    style: OverlayStyle = DEFAULT_STYLE,
    crf: int = VISUALLY_LOSSLESS,
    max_side: int | None = None,
    names: Mapping[int, str] = NO_NAMES,
) -> int:
    """Write frames with their moving objects drawn in, one frame in memory at a time.

    H.264 in 4:2:0 needs even sizes: an odd last row or column is repeated.

    Parameters
    ----------
    path : Path
        Ends in ``.mp4``; folders are created.
    frames : iterable of uint8 (y, x, rgb)
    labels : iterable of uint16 (y, x)
        As many as frames and of their size.
    fps : float or Fraction
        Frames per second, limited to 1/1001 to 1000.
    style : OverlayStyle
        How objects are drawn.
    crf : int
        Constant rate factor, 0 to 51: the smaller the better, and the larger the file.
    max_side : int, optional
        Frames whose longer side exceeds it are reduced to it before drawing, px.
    names : dict of int to str
        Names of objects by identity, for a style with their numbers.

    Returns
    -------
    int
        Number of frames written.

    Raises
    ------
    InputError
        Where there is no frame, numbers or sizes differ, or the file cannot be written.
    """
    drawn = _draw(frames, labels, path, style, max_side, names)
    return encode_video(path, drawn, fps, H264._replace(options={"crf": str(crf), "preset": PRESET}))


def encode_overlay(
    frames: Iterable[np.ndarray], labels: Iterable[np.ndarray], fps: float | Fraction, **options
) -> bytes:
    """Return the bytes of the file that `write_overlay` writes with these options.

    A temporary file is needed: the index can be moved to the front of a file only.
    """
    with tempfile.TemporaryDirectory(prefix="moseg-overlay-") as folder:
        path = Path(folder) / "overlay.mp4"
        write_overlay(path, frames, labels, fps, **options)
        return path.read_bytes()


def _draw(
    frames: Iterable[np.ndarray],
    labels: Iterable[np.ndarray],
    path: Path,
    style: OverlayStyle,
    max_side: int | None,
    names: Mapping[int, str],
) -> Iterator[np.ndarray]:
    for index, (image, mask) in enumerate(zip_longest(frames, labels)):
        _check_pair(image, mask, path, index)
        if max_side is not None:
            size = working_size(mask.shape, max_side)
            image, mask = shrink_to(image, size), resize_labels(mask, size)
        yield draw_overlay(image, mask, style, names)


def _check_pair(image: np.ndarray | None, mask: np.ndarray | None, path: Path, index: int) -> None:
    if image is None or mask is None:
        missing = "frame" if image is None else "mask"
        raise InputError("frames and masks differ in number", where=path, got=f"no {missing} {index}")
    if image.shape[:2] != mask.shape:
        raise InputError(f"wrong size of mask {index}", where=path, got=mask.shape, expected=image.shape[:2])
