"""Encoding of frames as a video file, one frame in memory at a time."""

import math
from collections.abc import Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import av
import numpy as np
from av.container import OutputContainer
from av.video.reformatter import ColorRange, Colorspace
from av.video.stream import VideoStream

from moseg.schemas.errors import InputError
from moseg.workflows.config.frame_rate import MAX_FPS
from moseg.workflows.exports.ownership import MARK
from moseg.workflows.process.atomic_write import atomic_path, blame_output

# ITU-T H.273: 1 is BT.709 for the primaries, the transfer function and the matrix.
_BT709 = 1
# Denominator of the NTSC rates, 30000/1001 frames per second and its kin.
_LARGEST_DENOMINATOR = 1001
_SLOWEST = Fraction(1, _LARGEST_DENOMINATOR)


class Encoding(NamedTuple):
    """Encoding of a video.

    Attributes
    ----------
    name : str
        Of the format, for errors.
    encoder : str
        FFmpeg's.
    container : str
        FFmpeg's muxer.
    pixels : str
        FFmpeg's pixel format in the file.
    options : mapping of str to str
        Of the encoder.
    muxer_options : mapping of str to str
    stream_tags : mapping of str to str
        Metadata of the stream.
    has_even_sizes : bool
        Whether an odd last row or column is repeated, because the format needs even sizes.
    """

    name: str
    encoder: str
    container: str
    pixels: str
    options: Mapping[str, str] = {}
    muxer_options: Mapping[str, str] = {}
    stream_tags: Mapping[str, str] = {}
    has_even_sizes: bool = True


def encode_video(path: Path, frames: Iterable[np.ndarray], fps: float | Fraction, encoding: Encoding) -> int:
    """Write frames of one size with moseg's mark, and return their number.

    Parameters
    ----------
    path : Path
        Folders are created.
    frames : iterable of uint8 (y, x, 3) RGB or (y, x, 4) RGB and alpha
    fps : float or Fraction
        Frames per second, limited to 1/1001 to 1000.
    encoding : Encoding

    Raises
    ------
    InputError
        There is no frame, the encoder is missing, or the file cannot be written.
    """
    if not 0 < fps < math.inf:
        raise InputError("impossible frame rate", where=path, got=fps, expected="frames per second above 0")
    require_encoder(encoding)
    num_frames = 0
    with atomic_path(path) as temporary:
        with blame_output(path, av.FFmpegError):
            options = dict(encoding.muxer_options)
            container = av.open(str(temporary), "w", format=encoding.container, options=options)
            container.metadata["comment"] = MARK
        with container:
            for image in frames:
                if encoding.has_even_sizes:
                    image = _pad_to_even(image)
                if not num_frames:
                    stream = _add_stream(container, image.shape, fps, encoding)
                frame = av.VideoFrame.from_ndarray(image, format="rgb24" if image.shape[2] == 3 else "rgba")
                # With several threads swscale gives some opaque pixels of yuva444p10le half their alpha.
                frame = frame.reformat(
                    format=encoding.pixels,
                    dst_colorspace=Colorspace.ITU709,
                    dst_color_range=ColorRange.MPEG,
                    threads=1,
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


def require_encoder(encoding: Encoding) -> None:
    """Raise InputError where PyAV was built without the encoder."""
    if encoding.encoder not in av.codecs_available:
        expected = f"a build with {encoding.encoder}"
        raise InputError(f"no {encoding.name} encoder", where=f"PyAV {av.__version__}", expected=expected)


def _add_stream(
    container: OutputContainer, shape: tuple[int, ...], fps: float | Fraction, encoding: Encoding
) -> VideoStream:
    rate = max(_SLOWEST, min(Fraction(fps), Fraction(MAX_FPS))).limit_denominator(_LARGEST_DENOMINATOR)
    stream = container.add_stream(encoding.encoder, rate=rate, options=dict(encoding.options))
    stream.height, stream.width = shape[:2]
    stream.pix_fmt = encoding.pixels
    stream.metadata.update(encoding.stream_tags)
    codec = stream.codec_context
    codec.color_primaries = codec.color_trc = codec.colorspace = _BT709
    codec.color_range = ColorRange.MPEG
    return stream


def _pad_to_even(image: np.ndarray) -> np.ndarray:
    return np.pad(image, ((0, image.shape[0] % 2), (0, image.shape[1] % 2), (0, 0)), mode="edge")
