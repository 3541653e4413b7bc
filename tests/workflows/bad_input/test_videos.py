"""Files that are no videos or damaged ones, and videos that are merely unusual."""

import os
import struct
from fractions import Fraction

import av
import numpy as np
import pytest
from PIL import Image

TEXT = b"Dear diary, today I filmed nothing at all.\n" * 40
NO_VIDEOS = {
    "letter.txt": TEXT,
    "letter.mp4": TEXT,
    "paper.pdf": b"%PDF-1.7\n1 0 obj\n<< /Type /Catalog >>\nendobj\ntrailer\n<< /Root 1 0 R >>\n%%EOF\n",
    "page.html": b"<!DOCTYPE html><html><body>404 not found</body></html>",
    "download.mp4": b"<!DOCTYPE html><html><body>404 not found</body></html>",
    "empty.mp4": b"",
    "subtitles.mp4": b"1\n00:00:00,000 --> 00:00:02,000\nHello\n\n",
    # FFmpeg would wait for such streams, or open other files and addresses.
    "stream.m3u8": b"#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:10,\nhttp://example.invalid/a.ts\n",
    "session.mp4": b"v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 5004 RTP/AVP 96\n",
    "list.mp4": b"ffconcat version 1.0\nfile 'video.mp4'\n",
}


@pytest.mark.parametrize("name", NO_VIDEOS)
def test_what_is_no_video_is_named(refuse, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(NO_VIDEOS[name])
    line = refuse(path, path)
    assert "not a video" in line or "no video stream" in line


def test_sound_alone_is_no_video(refuse, tmp_path):
    path = tmp_path / "song.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("aac", rate=8000)
        sound = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        sound.sample_rate = 8000
        container.mux(stream.encode(sound))
        container.mux(stream.encode(None))
    refuse(path, "no video stream", path, "got audio")


@pytest.mark.parametrize("path", ["/dev/null", "/dev/zero"])
def test_a_device_is_no_video(refuse, path):
    refuse(path, f"not a file in {path}", "expected a video file, or a folder of images")


@pytest.mark.parametrize("name", ["pipe.mp4", "frames/00003.png"])
def test_a_pipe_is_not_waited_for(refuse, write_folder, frames, tmp_path, name):
    write_folder("frames", frames[:3])
    os.mkfifo(tmp_path / name)
    refuse(tmp_path / name.partition("/")[0], "not a file", tmp_path / name)


@pytest.mark.parametrize("name", ["gone.mp4", "gone", "x" * 300])
def test_what_is_not_there_is_named(refuse, tmp_path, name):
    refuse(tmp_path / name, "does not exist", tmp_path / name)


@pytest.mark.parametrize("name", ["picture.jpg", "picture.mp4", "picture.gif"])
def test_a_picture_is_too_short_a_video(refuse, tmp_path, frames, name):
    kind = "GIF" if name.endswith("gif") else "JPEG"
    Image.fromarray(frames[0]).save(tmp_path / name, format=kind)
    refuse(tmp_path / name, "too few frames", "got 1", "expected at least 2")


def test_a_video_of_one_frame_is_too_short(refuse, write_video, frames):
    refuse(write_video(images=frames[:1]), "too few frames", "got 1", "expected at least 2")


def test_a_header_without_frames_is_no_video(refuse, tmp_path):
    path = tmp_path / "header.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=25)
        stream.height, stream.width, stream.pix_fmt = 48, 64, "yuv420p"
        container.start_encoding()
    refuse(path, "no ", "video", path)


def test_a_recording_that_lost_its_index_is_no_video(refuse, write_video):
    # The index of an mp4 comes last: a camera that dies leaves none.
    path = write_video()
    content = path.read_bytes()
    path.write_bytes(content[: content.index(b"moov") - 4])
    refuse(path, "video without an index", path)


@pytest.mark.parametrize("name", ["cut.mp4", "cut.mkv", "cut.webm"])
def test_a_download_that_was_cut_says_how_much_is_missing(refuse, write_video, name):
    codec = "libvpx-vp9" if name.endswith("webm") else "libx264"
    path = write_video(name, codec=codec, muxer={"movflags": "faststart"} if name.endswith("mp4") else None)
    content = path.read_bytes()
    kept = len(content) * 8 // 10
    path.write_bytes(content[:kept])
    refuse(path, f"cut short in {path}", f"got {len(content) - kept} bytes less", "expected an intact video")


@pytest.mark.parametrize(("name", "kept"), [("cut.ts", 0.6), ("cut.avi", 0.8)])
def test_a_video_cut_within_a_frame_names_it(refuse, write_video, name, kept):
    path = write_video(name, bf="2" if name.endswith("ts") else "0")
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    refuse(path, "decoding failed at frame ", path, "expected an intact video")


def test_damage_in_a_video_names_the_frame(refuse, write_video):
    path = write_video(bf="0", g="1")
    content = bytearray(path.read_bytes())
    start = content.index(b"mdat")
    middle = start + (content.index(b"moov") - start) // 2
    content[middle : middle + 400] = bytes(400)
    path.write_bytes(content)
    refuse(path, "decoding failed at frame ", path)


def test_a_video_that_changes_its_size_names_the_frame(refuse, write_video, scene, tmp_path):
    parts = [write_video(f"{height}.h264", scene(height, 64), bf="0").read_bytes() for height in (48, 96)]
    path = tmp_path / "joined.h264"
    path.write_bytes(b"".join(parts))
    refuse(path, "video changes its size", f"{path} at frame 5", "expected one size")


def test_what_was_segmented_before_outlives_a_bad_run(masks_of, refuse, write_video, tmp_path):
    masks_of(write_video())
    letter = tmp_path / "letter.mp4"
    letter.write_bytes(TEXT)
    refuse(letter, "not a video")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["masks", "motion.json", "overlay.mp4"]


def _turn(path, matrix):
    """Write a display matrix into the track header of version 0 (ISO/IEC 14496-12, 8.3.2)."""
    content = bytearray(path.read_bytes())
    a, b, c, d = (value << 16 for value in matrix)
    struct.pack_into(">9i", content, content.index(b"tkhd") + 44, a, b, 0, c, d, 0, 0, 0, 1 << 30)
    path.write_bytes(content)


def _overlay(folder):
    with av.open(str(folder / "overlay.mp4")) as container:
        return container.streams.video[0].average_rate, [
            f.to_ndarray(format="rgb24") for f in container.decode(video=0)
        ]


@pytest.mark.parametrize(
    ("matrix", "turned"),
    [
        ((0, 1, -1, 0), lambda image: np.rot90(image, -1)),
        ((-1, 0, 0, -1), lambda image: np.rot90(image, 2)),
        ((0, -1, 1, 0), np.rot90),
    ],
    ids=["90", "180", "270"],
)
def test_a_phone_held_upright_gives_upright_masks_and_overlay(masks_of, write_video, scene, tmp_path, matrix, turned):
    images = scene(46, 64)
    path = write_video(images=images, crf="5")
    _turn(path, matrix)
    shape = turned(images[0]).shape[:2]
    assert masks_of(path).shape == (5, *shape)
    _, drawn = _overlay(tmp_path / "out")
    assert {image.shape[:2] for image in drawn} == {shape}
    # Beyond the objects the overlay shows the video as it is.
    assert np.median(np.abs(drawn[0].astype(int) - turned(images[0]))) < 12


def test_a_turned_video_of_odd_size(masks_of, write_video, scene, tmp_path):
    path = write_video(images=scene(47, 63), pixels="yuv444p")
    _turn(path, (0, 1, -1, 0))
    assert masks_of(path).shape == (5, 63, 47)
    # H.264 in 4:2:0 wants even sizes: the last row and column are repeated.
    assert {image.shape[:2] for image in _overlay(tmp_path / "out")[1]} == {(64, 48)}


def test_a_variable_frame_rate_keeps_every_frame_once_and_the_average_rate(masks_of, write_video, tmp_path):
    assert len(masks_of(write_video(times=[0, 1, 2, 30, 45], bf="0"))) == 5
    rate, drawn = _overlay(tmp_path / "out")
    assert len(drawn) == 5
    assert 2 < rate < 5


UNUSUAL = {
    "10 bits": {"name": "a.mp4", "pixels": "yuv420p10le"},
    "full range": {"name": "a.avi", "codec": "mjpeg", "pixels": "yuvj420p"},
    "odd": {"name": "a.mkv", "codec": "ffv1", "pixels": "bgr0"},
    "grey": {"name": "a.mkv", "codec": "ffv1", "pixels": "gray"},
    "16-bit grey": {"name": "a.mkv", "codec": "ffv1", "pixels": "gray16le"},
    "alpha": {"name": "a.mov", "codec": "png", "pixels": "rgba"},
    "B-frames": {"name": "a.mp4", "bf": "3"},
    "interlaced": {"name": "a.mp4", "flags": "+ildct+ilme"},
}


@pytest.mark.parametrize("kind", UNUSUAL)
def test_unusual_coding_gives_masks_of_every_frame(masks_of, write_video, scene, kind):
    size = (47, 63) if kind == "odd" else (48, 64)
    masks = masks_of(write_video(images=scene(*size), **UNUSUAL[kind]))
    assert masks.shape == (5, *size)
    assert masks.any()


def test_pixels_that_are_not_square_stay_as_coded(masks_of, write_video):
    def set_up(stream):
        stream.sample_aspect_ratio = Fraction(4, 3)

    assert masks_of(write_video(set_up=set_up)).shape == (5, 48, 64)


@pytest.mark.parametrize("kind", ["full range", "10 bits", "16-bit grey", "alpha"])
def test_unusual_coding_keeps_the_brightness(write_video, frames, kind):
    from moseg.workflows.sources import VideoFile

    path = write_video(**UNUSUAL[kind])
    found = np.stack(list(VideoFile(str(path), 1000).read())).astype(int)
    expected = np.stack(frames).astype(int)
    assert abs(found.mean() - expected.mean()) < 4
    assert abs(found.std() - expected.std()) < 12 or kind == "16-bit grey"


def test_titles_that_are_no_utf8_are_no_obstacle(masks_of, write_video, frames, tmp_path):
    path = write_video()
    with (
        av.open(str(path)) as source,
        av.open(str(tmp_path / "latin.mp4"), "w", metadata_encoding="latin-1") as target,
    ):
        stream = target.add_stream_from_template(source.streams.video[0])
        target.metadata["title"] = "Caf\xe9 M\xfcller"
        stream.metadata["handler_name"] = "Vid\xe9o"
        for packet in source.demux(video=0):
            if packet.dts is not None:
                packet.stream = stream
                target.mux(packet)
    content = (tmp_path / "latin.mp4").read_bytes()
    assert b"Caf\xe9 M\xfcller" in content and b"Vid\xe9o" in content
    np.testing.assert_array_equal(masks_of(tmp_path / "latin.mp4"), masks_of(path))


def test_an_animation_is_a_video(masks_of, frames, tmp_path):
    first, *others = map(Image.fromarray, frames)
    first.save(tmp_path / "a.gif", save_all=True, append_images=others, duration=40)
    assert masks_of(tmp_path / "a.gif").shape == (5, 48, 64)
