"""Frames from a video file."""

import math
import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass, replace

import av
import numpy as np
from av.container import InputContainer
from av.sidedata.sidedata import SideDataContainer
from av.stream import Disposition
from av.video.stream import VideoStream

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources.files import digest_file
from moseg.workflows.sources.frames import FrameDescription
from moseg.workflows.sources.pillow_image import MAX_PIXELS
from moseg.workflows.sources.resize import shrink_to, working_size
from moseg.workflows.sources.truncation import bytes_without_index, missing_bytes

DECODING_VERSION = 2
"""Raised when `VideoFile.read` starts to yield other pixels for the same bytes."""
NOT_VIDEOS = frozenset(("tty", "hls", "dash", "concat", "sdp", "rtp", "rtsp", "imf"))
"""FFmpeg's demuxers that turn a text file into 'video', or read other files and addresses named in a text."""
METADATA_ERRORS = "replace"
"""Handling of titles and comments that are not UTF-8: many programs write Latin-1."""
VIDEOS = "a video file, or a folder of images"
WITH_INDEX = "the whole file: without its index (moov) no frame can be decoded"
REPAIR = "an intact video (ffmpeg -i IN OUT.mp4 re-encodes what can be read)"


@dataclass(frozen=True)
class VideoFile:
    """The first video stream of a file.

    Every decoded frame is yielded once whatever its time stamp, so a variable frame rate neither repeats nor drops any.
    Non-square pixels are not resampled.

    Attributes
    ----------
    path : str
    max_side : int
        Frames whose longer side exceeds it are area-resized to it, px.
    numbers : tuple of int, optional
        Frames to read, ascending, counted from 0; all where None.
    """

    path: str
    max_side: int
    numbers: tuple[int, ...] | None = None

    def fingerprint(self) -> str:
        """Return the digest of the file's bytes and the decode parameters."""
        chosen = [] if self.numbers is None else [self.numbers]
        return digest_json("source", ["video", DECODING_VERSION, self.max_side, digest_file(self.path), *chosen])

    def read(self) -> Iterator[np.ndarray]:
        """Yield each frame as uint8 (y, x, 3) RGB, upright.

        Raises
        ------
        InputError
            Not a video, no frame in it, or a video that cannot be decoded to its end: no frame is lost unreported.
        """
        size = None
        for number, frame in self._decode_chosen():
            image = _to_array(frame)
            size = size or image.shape[:2]
            if image.shape[:2] != size:
                raise InputError("video changes its size", where=f"{self.path} at frame {number}", expected="one size")
            yield shrink_to(image, working_size(size, self.max_side))
        if size is None:
            raise InputError("no frame in the video", where=self.path)

    def describe(self) -> FrameDescription:
        """Return the size of the first frame, upright, and the average frame rate."""
        frames = self._decode()
        first = next(frames, None)
        frames.close()
        if first is None:
            raise InputError("no frame in the video", where=self.path)
        with _open(self.path) as container:
            stream = _video_stream(container, self.path)
            rate = stream.average_rate or stream.guessed_rate
        return FrameDescription(_to_array(first).shape[:2], float(rate) if rate else None)

    def num_frames(self) -> int:
        """Return the number of frames that decode; the count in a file's header may be wrong, so all are decoded."""
        return sum(1 for _ in self._decode()) if self.numbers is None else len(self.numbers)

    def times(self) -> Iterator[float]:
        """Yield the time of each frame of the file since the first one, s: by its time stamp, or else by the rate.

        NaN where the file has neither.
        """
        origin, fps = None, self.describe().fps or math.nan
        for number, frame in enumerate(self._decode()):
            if number == 0:
                origin = frame.time
            yield number / fps if frame.time is None or origin is None else frame.time - origin

    def choose(self, numbers: tuple[int, ...]) -> "VideoFile":
        """Return the source of these frames alone."""
        return replace(self, numbers=numbers)

    def chunks(self, size: int) -> tuple["VideoFile", ...]:
        """Return the source itself: a video decodes from its beginning."""
        return (self,)

    def _decode_chosen(self) -> Iterator[tuple[int, av.VideoFrame]]:
        """Yield frames with their numbers; nothing is decoded after the last one that is read."""
        frames = enumerate(self._decode())
        if self.numbers is None:
            yield from frames
            return
        for wanted in self.numbers:
            found = next((each for each in frames if each[0] == wanted), None)
            if found is None:
                raise InputError("no such frame", where=self.path, got=wanted)
            yield found

    def _decode(self) -> Iterator[av.VideoFrame]:
        number = 0
        with _open(self.path) as container:
            stream = _video_stream(container, self.path)
            if missing := missing_bytes(self.path):
                raise InputError("video is cut short", where=self.path, got=f"{missing} bytes less", expected=REPAIR)
            try:
                for packet in container.demux(stream):
                    for frame in packet.decode():
                        if frame.is_corrupt:
                            raise _broken(self.path, number, "damaged data")
                        yield frame
                        number += 1
                    if packet.is_corrupt:
                        raise _broken(self.path, number, "a damaged packet")
            except av.FFmpegError as error:
                raise _broken(self.path, number, error.strerror) from error


def count_packets(path: str) -> int:
    """Return the packets of a video's stream, nearly always one a frame; they are not decoded."""
    with _open(path) as container:
        stream = _video_stream(container, path)
        try:
            return sum(packet.size > 0 for packet in container.demux(stream))
        except av.FFmpegError as error:
            raise _broken(path, 0, error.strerror) from error


def _to_array(frame: av.VideoFrame) -> np.ndarray:
    image = frame.to_ndarray(format="rgb24")
    # `frame.side_data` and its frame would refer to each other: each decoded frame would stay in memory, and its
    # decoder's threads alive, until garbage is collected.
    matrix = SideDataContainer(frame).get("DISPLAYMATRIX")
    return image if matrix is None else upright(image, bytes(matrix))


def _open(path: str) -> InputContainer:
    if not os.path.exists(path):
        raise MissingInputError("file does not exist", where=path)
    if not os.path.isfile(path):
        raise InputError("not a file", where=path, expected=VIDEOS)
    if os.path.getsize(path) == 0:
        raise InputError("not a video", where=path, got="an empty file", expected=VIDEOS)
    # Refused before they are opened: for a playlist FFmpeg may wait for a stream that never comes.
    formats = ",".join(sorted(av.formats_available - NOT_VIDEOS))
    try:
        # The prefix prevents FFmpeg from taking "a:b.mp4" for a URL of protocol "a".
        return av.open(
            f"file:{path}",
            options={"format_whitelist": formats, "protocol_whitelist": "file"},
            metadata_errors=METADATA_ERRORS,
        )
    except av.ArgumentError as error:
        raise InputError("not a video", where=path, got="text or a playlist", expected=VIDEOS) from error
    except av.FFmpegError as error:
        _check_index(path)
        raise InputError("not a video", where=path, got=error.strerror, expected=VIDEOS) from error


def _check_index(path: str) -> None:
    """Raise InputError if a file that cannot be opened, or has no stream, is a video that lacks its index."""
    missing = bytes_without_index(path)
    if missing:
        got = f"no index, and at least {missing} bytes less"
        raise InputError("video is cut short", where=path, got=got, expected=WITH_INDEX)
    if missing == 0:
        got = "a recording that did not end, or a part of a file"
        raise InputError("video without an index", where=path, got=got, expected=WITH_INDEX)


def _video_stream(container: InputContainer, path: str) -> VideoStream:
    stream = container.streams.best("video")
    if stream is None or stream.disposition & Disposition.attached_pic:
        _check_index(path)
        got = ", ".join(sorted({other.type for other in container.streams})) or "nothing"
        raise InputError("no video stream", where=path, got=got)
    if stream.codec_context is None:
        raise InputError("no decoder for the video stream", where=path)
    codec = stream.codec_context
    if codec.width * codec.height > MAX_PIXELS:
        got, expected = f"{codec.width}x{codec.height} px", f"at most {MAX_PIXELS} px"
        raise InputError("video of too many pixels", where=path, got=got, expected=expected)
    # The decoder refuses larger sizes later in the data.
    codec.options = {"max_pixels": str(MAX_PIXELS)}
    # With a thread for each slice, FFmpeg does not report damaged slices.
    codec.thread_type = "NONE"
    return stream


def _broken(path: str, number: int, reason: str) -> InputError:
    return InputError(f"decoding failed at frame {number}", where=path, got=reason, expected=REPAIR)


def upright(image: np.ndarray, matrix: bytes) -> np.ndarray:
    """Apply a display matrix's quarter turns and mirrorings.

    Parameters
    ----------
    image : (y, x, channel)
    matrix : bytes
        Nine native int32, rows (a, b, u), (c, d, v), (x, y, w): a point goes to x' = a x + c y, y' = b x + d y, axes
        right and down (FFmpeg's `libavutil/display.h`). Scale and translation are ignored, and an angle between two
        quarter turns goes to the nearer one.

    Returns
    -------
    (y', x', channel), contiguous
    """
    a, b, _, c, d, _, _, _, _ = struct.unpack("=9i", matrix)
    if abs(b) + abs(c) > abs(a) + abs(d):
        image, from_x, from_y = image.swapaxes(0, 1), c, b
    else:
        from_x, from_y = a, d
    if from_y < 0:
        image = image[::-1]
    if from_x < 0:
        image = image[:, ::-1]
    return np.ascontiguousarray(image)
