import gc
import struct
from pathlib import Path

import av
import numpy as np
import pytest

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources import VideoFile, video_file
from moseg.workflows.sources.truncation import bytes_without_index, missing_bytes


@pytest.fixture
def moving(picture):
    return [np.roll(picture, 2 * i, axis=1) for i in range(12)]


def assert_nearly(frames, expected):
    assert len(frames) == len(expected)
    for frame, image in zip(frames, expected, strict=True):
        assert frame.shape == image.shape
        assert frame.dtype == np.uint8
        assert np.abs(frame.astype(int) - image).mean() < 12


@pytest.mark.parametrize("suffix", [".mp4", ".mkv", ".mov", ".avi", ".ts"])
def test_every_frame_comes_once_in_order(tmp_path, write_video, moving, suffix):
    video = VideoFile(write_video(tmp_path / f"a{suffix}", moving), 1000)
    assert_nearly(list(video.read()), moving)
    assert video.describe() == ((48, 64), 25.0)
    assert video.num_frames() == len(moving)
    assert video.chunks(3) == (video,)


def test_variable_frame_rate_neither_repeats_nor_drops(tmp_path, write_video, moving):
    times = [0, 1, 2, 30, 31, 60, 61, 62, 63, 100, 101, 140]
    video = VideoFile(write_video(tmp_path / "a.mp4", moving, times=times), 1000)
    assert_nearly(list(video.read()), moving)


@pytest.mark.parametrize(
    ("matrix", "turned"),
    [
        ((0, -1, 1, 0), lambda a: np.rot90(a, 1)),
        ((-1, 0, 0, -1), lambda a: np.rot90(a, 2)),
        ((0, 1, -1, 0), lambda a: np.rot90(a, -1)),
        ((-1, 0, 0, 1), np.fliplr),
        ((0, 1, 1, 0), lambda a: a.swapaxes(0, 1)),
    ],
)
def test_rotation_in_the_file_is_applied(tmp_path, write_video, moving, matrix, turned):
    path = tmp_path / "a.mp4"
    write_video(path, moving)
    content = bytearray(path.read_bytes())
    # The matrix lies 40 bytes into a track header of version 0 (ISO/IEC 14496-12, 8.3.2).
    a, b, c, d = (value << 16 for value in matrix)
    struct.pack_into(">9i", content, content.index(b"tkhd") + 44, a, b, 0, c, d, 0, 0, 0, 1 << 30)
    path.write_bytes(content)
    video = VideoFile(str(path), 1000)
    assert_nearly(list(video.read()), [turned(image) for image in moving])
    assert video.describe().size == turned(moving[0]).shape[:2]


def test_longer_side_is_limited(tmp_path, write_video, moving):
    video = VideoFile(write_video(tmp_path / "a.mp4", moving), 32)
    assert {frame.shape for frame in video.read()} == {(24, 32, 3)}
    assert video.describe().size == (48, 64)


def test_one_frame_is_a_video(tmp_path, write_video, moving):
    assert_nearly(list(VideoFile(write_video(tmp_path / "a.mp4", moving[:1]), 1000).read()), moving[:1])


def test_names_with_blanks_colons_and_other_scripts_work(tmp_path, write_video, moving):
    path = tmp_path / "a.mp4"
    write_video(path, moving)
    path = path.rename(tmp_path / "http: видео 映像%03d.mp4")
    assert len(list(VideoFile(str(path), 1000).read())) == 12


@pytest.mark.parametrize("suffix", [".mp4", ".mkv"])
@pytest.mark.parametrize("kept", [0.6, 0.95])
def test_a_truncated_video_is_refused(tmp_path, write_video, moving, suffix, kept):
    path = tmp_path / f"a{suffix}"
    write_video(path, moving)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    with pytest.raises(InputError, match=rf"cut short in .*a{suffix}; got {len(content) - int(kept * len(content))} "):
        list(VideoFile(str(path), 1000).read())


@pytest.fixture
def with_index_at_the_end(tmp_path, moving):
    """Return the bytes of an mp4 whose index is its last box, and where that begins."""
    path = tmp_path / "whole.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.height, stream.width, stream.pix_fmt = *moving[0].shape[:2], "yuv420p"
        for image in moving:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode(None))
    content = path.read_bytes()
    return content, content.index(b"moov") - 4


@pytest.mark.parametrize("part", [0.3, 0.9])
def test_a_video_that_lost_its_index_is_cut_short_and_no_unknown_format(tmp_path, with_index_at_the_end, part):
    content, index = with_index_at_the_end
    path = tmp_path / "a.mp4"
    path.write_bytes(content[: int(part * index)])
    missing = index - int(part * index)
    with pytest.raises(InputError, match=rf"cut short in .*a.mp4; got no index, and at least {missing} bytes less"):
        list(VideoFile(str(path), 1000).read())
    # Within the index itself.
    path.write_bytes(content[: index + 40])
    with pytest.raises(InputError, match=rf"; got no index, and at least {len(content) - index - 40} bytes less"):
        list(VideoFile(str(path), 1000).read())


def test_a_recording_that_did_not_end_has_no_index(tmp_path, with_index_at_the_end):
    content, index = with_index_at_the_end
    path = tmp_path / "a.mp4"
    path.write_bytes(content[:index])
    message = r"video without an index in .*a.mp4; got a recording that did not end.*; expected the whole file"
    with pytest.raises(InputError, match=message):
        list(VideoFile(str(path), 1000).read())
    # A camera writes the length of the samples when the recording ends.
    start = content.index(b"mdat") - 4
    path.write_bytes(content[:start] + bytes(4) + content[start + 4 : index - 100])
    with pytest.raises(InputError, match=message):
        list(VideoFile(str(path), 1000).read())


def test_what_is_no_media_file_has_no_index_to_lose(tmp_path):
    path = tmp_path / "a.mp4"
    path.write_bytes(b"<html>" * 100)
    assert bytes_without_index(str(path)) is None
    with pytest.raises(InputError, match="not a video"):
        list(VideoFile(str(path), 1000).read())


def test_a_header_longer_than_any_file_counts_as_missing_bytes(tmp_path, write_video, moving):
    path = tmp_path / "a.mkv"
    write_video(path, moving)
    content = bytearray(path.read_bytes())
    content[4] = 0x01  # the length of the EBML header now takes the seven bytes that follow
    path.write_bytes(content)
    assert missing_bytes(str(path)) > 2**48


def test_a_video_whose_header_was_never_written_is_refused(tmp_path, write_video, moving):
    path = tmp_path / "a.mp4"
    write_video(path, moving)
    content = path.read_bytes()
    path.write_bytes(content[:32] + content[content.index(b"mdat") - 4 :])
    with pytest.raises(InputError, match=r"video without an index in .*a\.mp4"):
        list(VideoFile(str(path), 1000).read())


def test_damage_is_reported_with_its_frame(tmp_path, write_video, moving):
    path = tmp_path / "a.mp4"
    write_video(path, moving * 3, bf="0")
    content = bytearray(path.read_bytes())
    start = content.index(b"mdat")
    damaged = slice(start + (len(content) - start) * 7 // 10, start + (len(content) - start) * 8 // 10)
    content[damaged] = bytes(damaged.stop - damaged.start)
    path.write_bytes(content)
    frames = []
    with pytest.raises(InputError, match=r"decoding failed at frame [1-9]") as caught:
        frames.extend(VideoFile(str(path), 1000).read())
    assert "re-encodes" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_damage_within_one_slice_of_a_frame_is_reported(tmp_path, write_video, moving):
    path = tmp_path / "a.mp4"
    write_video(path, [np.tile(image, (8, 8, 1)) for image in moving], slices="4")
    with av.open(str(path)) as container:
        packet = next(container.demux(video=0))
        start = packet.pos + packet.size * 2 // 5
    content = np.fromfile(path, np.uint8)
    content[start : start + 60] ^= 0x55
    content.tofile(path)
    with pytest.raises(InputError, match=r"decoding failed at frame 0 in .*a\.mp4; got damaged data"):
        list(VideoFile(str(path), 1000).read())


@pytest.mark.parametrize("name", ["a.mp4", "a.txt"])
@pytest.mark.parametrize("content", [b"", b"not a video\n" * 100])
def test_other_files_are_not_videos(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=r"not a video|no video stream"):
        list(VideoFile(str(tmp_path / name), 1000).read())


def test_a_file_of_sound_only_is_refused(tmp_path):
    with av.open(str(tmp_path / "a.wav"), "w") as container:
        stream = container.add_stream("pcm_s16le", rate=8000)
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), format="s16", layout="mono")
        frame.sample_rate = 8000
        container.mux(stream.encode(frame))
    with pytest.raises(InputError, match=r"no video stream in .*a\.wav; got audio"):
        list(VideoFile(str(tmp_path / "a.wav"), 1000).read())


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(MissingInputError, match=r"gone\.mp4"):
        VideoFile(str(tmp_path / "gone.mp4"), 1000).describe()


def test_a_video_of_too_many_pixels_is_refused_before_it_is_decoded(write_video, picture, tmp_path, monkeypatch):
    path = write_video(tmp_path / "a.mp4", [picture] * 3)
    monkeypatch.setattr(video_file, "MAX_PIXELS", 48 * 64)
    assert VideoFile(path, 1000).num_frames() == 3
    monkeypatch.setattr(video_file, "MAX_PIXELS", 48 * 64 - 1)
    with pytest.raises(InputError, match=r"video of too many pixels in .*a\.mp4; got 64x48 px; expected at most 3071"):
        list(VideoFile(path, 1000).read())


def test_a_video_whose_frames_become_too_large_names_the_frame(write_video, picture, tmp_path, monkeypatch):
    large = np.tile(picture, (2, 2, 1))
    parts = [write_video(tmp_path / f"{image.shape[0]}.h264", [image] * 3) for image in (picture, large)]
    path = tmp_path / "joined.h264"
    path.write_bytes(b"".join(Path(part).read_bytes() for part in parts))
    monkeypatch.setattr(video_file, "MAX_PIXELS", 48 * 64)
    with pytest.raises(InputError, match=r"decoding failed at frame [0-3] in .*joined\.h264"):
        list(VideoFile(str(path), 1000).read())


def test_decoded_frames_do_not_stay_in_memory(write_video, picture, tmp_path):
    path = write_video(tmp_path / "a.mp4", [picture] * 10)
    gc.collect()
    gc.disable()
    try:
        assert sum(1 for _ in VideoFile(path, 1000).read()) == 10
        assert not [found for found in gc.get_objects() if issubclass(type(found), av.VideoFrame)]
    finally:
        gc.enable()
