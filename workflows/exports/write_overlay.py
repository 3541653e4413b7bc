"""Video with its moving objects drawn in: H.264 in MP4, which browsers play."""

import math
import tempfile
from collections.abc import Iterable
from fractions import Fraction
from itertools import zip_longest
from pathlib import Path

import av
import numpy as np
from av.video.reformatter import ColorRange, Colorspace

from moseg.schemas.errors import InputError
from moseg.workflows.config.frame_rate import MAX_FPS
from moseg.workflows.exports.draw_overlay import draw_overlay
from moseg.workflows.exports.overlay_style import DEFAULT_STYLE, OverlayStyle
from moseg.workflows.exports.ownership import MARK
from moseg.workflows.process.atomic_write import atomic_path, blame_output
from moseg.workflows.sources.resize import resize_labels, shrink_to, working_size

_ENCODER = "libx264"
VISUALLY_LOSSLESS = 18
"""Constant rate factor of x264, whose scale runs from 0, lossless, to 51; its authors call 18 visually lossless."""
# ITU-T H.273: 1 is BT.709 for the primaries, the transfer function and the matrix.
_BT709 = 1
# Denominator of the NTSC rates, 30000/1001 frames per second and its kin.
_LARGEST_DENOMINATOR = 1001
_SLOWEST = Fraction(1, _LARGEST_DENOMINATOR)


def write_overlay(
    path: Path,
    frames: Iterable[np.ndarray],
    labels: Iterable[np.ndarray],
    fps: float | Fraction,
    style: OverlayStyle = DEFAULT_STYLE,
    crf: int = VISUALLY_LOSSLESS,
    max_side: int | None = None,
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

    Returns
    -------
    int
        Number of frames written.

    Raises
    ------
    InputError
        Where there is no frame, numbers or sizes differ, or the file cannot be written.
    """
    if not 0 < fps < math.inf:
        raise InputError("impossible frame rate", where=path, got=fps, expected="frames per second above 0")
    if _ENCODER not in av.codecs_available:
        raise InputError("no H.264 encoder", where=f"PyAV {av.__version__}", expected=f"a build with {_ENCODER}")
    num_frames = 0
    with atomic_path(path) as temporary:
        with blame_output(path, av.FFmpegError):
            container = av.open(str(temporary), "w", format="mp4", options={"movflags": "+faststart"})
            container.metadata["comment"] = MARK
        with container:
            for image, mask in zip_longest(frames, labels):
                _check_pair(image, mask, path, num_frames)
                if max_side is not None:
                    size = working_size(mask.shape, max_side)
                    image, mask = shrink_to(image, size), resize_labels(mask, size)
                drawn = _pad_to_even(draw_overlay(image, mask, style))
                if not num_frames:
                    stream = _add_stream(container, drawn.shape, fps, crf)
                frame = av.VideoFrame.from_ndarray(drawn, format="rgb24")
                frame = frame.reformat(
                    format="yuv420p", dst_colorspace=Colorspace.ITU709, dst_color_range=ColorRange.MPEG
                )
                with blame_output(path, av.FFmpegError):
                    container.mux(stream.encode(frame))
                num_frames += 1
            if not num_frames:
                raise InputError("no frame to write", where=path, got=0, expected="at least 1")
            with blame_output(path, av.FFmpegError):
                container.mux(stream.encode(None))
                container.close()
    return num_frames


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


def _add_stream(container: av.container.OutputContainer, shape: tuple[int, ...], fps: float | Fraction, crf: int):
    rate = max(_SLOWEST, min(Fraction(fps), Fraction(MAX_FPS))).limit_denominator(_LARGEST_DENOMINATOR)
    stream = container.add_stream(_ENCODER, rate=rate, options={"crf": str(crf)})
    stream.height, stream.width = shape[:2]
    stream.pix_fmt = "yuv420p"
    codec = stream.codec_context
    codec.color_primaries = codec.color_trc = codec.colorspace = _BT709
    codec.color_range = ColorRange.MPEG
    return stream


def _pad_to_even(image: np.ndarray) -> np.ndarray:
    return np.pad(image, ((0, image.shape[0] % 2), (0, image.shape[1] % 2), (0, 0)), mode="edge")


def _check_pair(image: np.ndarray | None, mask: np.ndarray | None, path: Path, index: int) -> None:
    if image is None or mask is None:
        missing = "frame" if image is None else "mask"
        raise InputError("frames and masks differ in number", where=path, got=f"no {missing} {index}")
    if image.shape[:2] != mask.shape:
        raise InputError(f"wrong size of mask {index}", where=path, got=mask.shape, expected=image.shape[:2])
