"""The video with its moving objects drawn in: H.264 in MP4, as browsers play it."""

import math
from collections.abc import Iterable
from fractions import Fraction
from itertools import zip_longest
from pathlib import Path

import av
import numpy as np
from av.video.reformatter import ColorRange, Colorspace

from schemas.errors import InputError
from workflows.exports.atomic_write import atomic_path, blame_output
from workflows.exports.draw_labels import draw_labels

_ENCODER = "libx264"
# x264's scale of quality runs from 0, lossless, to 51; its authors call 18 visually lossless.
_CONSTANT_RATE_FACTOR = "18"
# ITU-T H.273: 1 is BT.709 for the primaries, the transfer function and the matrix.
_BT709 = 1
# Denominator of the NTSC rates, 30000/1001 frames per second and its kin.
_LARGEST_DENOMINATOR = 1001


def write_overlay(path: Path, frames: Iterable[np.ndarray], labels: Iterable[np.ndarray], fps: float | Fraction) -> int:
    """Write frames with their moving objects drawn in, one frame in memory at a time.

    H.264 in 4:2:0 wants even sizes: an odd last row or column is repeated.

    Parameters
    ----------
    path : Path
        Ends in ``.mp4``; folders are created.
    frames : iterable of uint8 (y, x, rgb)
    labels : iterable of uint16 (y, x)
        As many as frames and of their size.
    fps : float or Fraction
        Frames per second.

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
        with container:
            for image, mask in zip_longest(frames, labels):
                _check_pair(image, mask, path, num_frames)
                if not num_frames:
                    stream = _add_stream(container, image.shape, fps)
                frame = av.VideoFrame.from_ndarray(_pad_to_even(draw_labels(image, mask)), format="rgb24")
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


def _add_stream(container: av.container.OutputContainer, shape: tuple[int, ...], fps: float | Fraction):
    rate = Fraction(fps).limit_denominator(_LARGEST_DENOMINATOR)
    stream = container.add_stream(_ENCODER, rate=rate, options={"crf": _CONSTANT_RATE_FACTOR})
    stream.height, stream.width = shape[0] + shape[0] % 2, shape[1] + shape[1] % 2
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
