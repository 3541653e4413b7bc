"""Frames chosen by numbers and by times, from words to the results."""

import json

import av
import cv2
import numpy as np
import pytest
from PIL import Image

import moseg as python
from moseg.schemas.errors import InputError
from moseg.workflows.api.video_source import choose_frames
from moseg.workflows.config.frame_range import FrameRange, Position, read_frame_range, read_position
from moseg.workflows.sources import ImageFiles, VideoFile

NUM_FRAMES, FPS = 12, 10


@pytest.fixture(scope="module")
def clip(tmp_path_factory):
    """Return a lossless video and a folder of the same frames, each with its number as its grey level."""
    root = tmp_path_factory.mktemp("clip")
    texture = np.random.default_rng(0).integers(0, 120, (48, 64), dtype=np.uint8)
    frames = [np.repeat((texture + 10 * number)[..., None], 3, axis=2) for number in range(NUM_FRAMES)]
    (root / "frames").mkdir()
    for number, frame in enumerate(frames):
        cv2.imwrite(str(root / "frames" / f"{number:05d}.png"), frame)
    with av.open(str(root / "video.mkv"), "w") as container:
        stream = container.add_stream("ffv1", rate=FPS)
        stream.height, stream.width, stream.pix_fmt = 48, 64, "bgr0"
        for frame in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(frame, format="rgb24")))
        container.mux(stream.encode(None))
    return root


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return tmp_path_factory.mktemp("ranges") / "store"


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("120", (120, False)),
        (7, (7, False)),
        ("4.5s", (4.5, True)),
        ("4 s", (4, True)),
        ("0:04.5", (4.5, True)),
        ("1:02:03", (3723, True)),
    ],
)
def test_a_position_is_a_frame_or_a_time(words, expected):
    assert read_position(words, "--start") == Position(*expected)


@pytest.mark.parametrize("words", ["4.5", "-3", "", "soon", "1:2:3:4", "1e3", "0x10", "5 frames", "infs", "nans"])
def test_what_may_be_either_or_neither_is_refused(words):
    with pytest.raises(InputError, match=r"neither a frame nor a time in --start; got .*expected a frame"):
        read_frame_range(start=words)


@pytest.mark.parametrize(
    ("given", "where"),
    [
        ({"every": "0"}, "--every"),
        ({"every": "0s"}, "--every"),
        ({"start": 5, "end": 5}, "--end"),
        ({"end": 0}, "--end"),
    ],
)
def test_a_range_of_no_frames_is_refused(given, where):
    with pytest.raises(InputError, match=where):
        read_frame_range(**given)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"start": 4}, [4, 5, 6, 7, 8, 9, 10, 11]),
        ({"end": 3}, [0, 1, 2]),
        ({"start": 2, "end": 9, "every": 3}, [2, 5, 8]),
        ({"start": "0.4s", "end": "0.7s"}, [4, 5, 6]),
        ({"start": 3, "end": "0.6s"}, [3, 4, 5]),
        ({"every": "0.3s"}, [0, 3, 6, 9]),
        ({"start": "0.15s", "every": "0.25s"}, [2, 4, 7, 9]),
        ({"every": "0.01s"}, [*range(NUM_FRAMES)]),
        ({"end": 99}, [*range(NUM_FRAMES)]),
    ],
)
def test_a_video_and_its_frames_give_the_same_frames(clip, given, expected):
    chosen, frames = read_frame_range(**given), sorted((clip / "frames").iterdir())
    video = choose_frames(VideoFile(str(clip / "video.mkv"), 1000), chosen)
    images = choose_frames(ImageFiles(tuple(map(str, frames)), 1000), chosen, FPS)
    np.testing.assert_array_equal(np.stack([*video.read()]), np.stack([*images.read()]))
    assert images.paths == tuple(str(frames[number]) for number in expected)
    assert video.num_frames() == len(expected)


def test_a_range_of_all_frames_has_the_key_of_the_whole(clip):
    whole = VideoFile(str(clip / "video.mkv"), 1000)
    assert choose_frames(whole, read_frame_range(start=0, end=NUM_FRAMES, every=1)) == whole
    assert choose_frames(whole, read_frame_range(end=5)).fingerprint() != whole.fingerprint()


def test_times_are_those_of_the_time_stamps(tmp_path):
    times = [0, 10, 20, 30, 70, 80]
    with av.open(str(tmp_path / "a.mkv"), "w") as container:
        stream = container.add_stream("ffv1", rate=100)
        stream.height, stream.width, stream.pix_fmt = 48, 64, "bgr0"
        for time in times:
            frame = av.VideoFrame.from_ndarray(np.zeros((48, 64, 3), np.uint8), format="rgb24")
            # A file need not begin at 0.
            frame.pts = 500 + time
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    video = VideoFile(str(tmp_path / "a.mkv"), 1000)
    np.testing.assert_allclose([*video.times()], [time / 100 for time in times])
    assert choose_frames(video, read_frame_range(start="0.25s", end="0.75s")).numbers == (3, 4)


def test_reading_ends_with_the_last_chosen_frame(clip, monkeypatch):
    decoded = []
    original = VideoFile._decode

    def counted(self):
        for frame in original(self):
            decoded.append(frame)
            yield frame

    monkeypatch.setattr(VideoFile, "_decode", counted)
    assert len([*VideoFile(str(clip / "video.mkv"), 1000, (1, 3)).read()]) == 2
    assert len(decoded) == 4


@pytest.mark.parametrize(
    ("kind", "given", "words"),
    [
        ("video.mkv", ("--start", "50"), ("no frame chosen", "12 frames")),
        ("video.mkv", ("--start", "9s"), ("no frame chosen", "12 frames, the last one at 1.100 s")),
        ("video.mkv", ("--start", "11"), ("too few frames to see motion",)),
        ("frames", ("--start", "0.5s"), ("a time needs a frame rate", "--fps")),
        ("frames", ("--end", "0"), ("no frame chosen in --end",)),
    ],
)
def test_a_range_without_two_frames_is_one_line(moseg, clip, store, tmp_path, kind, given, words):
    ran = moseg("segment", clip / kind, *given, "--store", store, "--out", tmp_path / "out", "--quiet")
    assert (ran.code, ran.out) == (2, "")
    (line,) = ran.err.splitlines()
    assert all(word in line for word in words), line


def test_results_say_which_frames_they_are_and_reuse_what_the_whole_left(moseg, clip, store, tmp_path):
    def segmented(*given):
        out = tmp_path / "out"
        command = (
            "segment",
            clip / "video.mkv",
            "--quality",
            "fast",
            "--store",
            store,
            "--out",
            out,
            "--quiet",
            "--keep-cues",
        )
        ran = moseg(*command, *given)
        assert (ran.code, ran.err) == (0, "")
        return json.loads((out / "motion.json").read_text()), ran.out

    whole, _ = segmented()
    assert (whole["num_frames"], whole["numbers"], whole["fps"]) == (NUM_FRAMES, None, FPS)
    part, line = segmented("--start", "4", "--end", "10")
    assert (part["num_frames"], part["numbers"], part["fps"]) == (6, [4, 5, 6, 7, 8, 9], FPS)
    assert part["video"] == whole["video"]
    # The flow of five pairs in both directions at least.
    assert int(line.split(" reused")[0].split()[-1]) >= 10
    thinned, _ = segmented("--every", "0.2s")
    assert (thinned["numbers"], thinned["fps"]) == ([0, 2, 4, 6, 8, 10], FPS / 2)
    assert len(list((tmp_path / "out" / "masks").iterdir())) == 6


def test_the_overlay_of_a_range_at_full_size_has_its_frames(moseg, clip, store, tmp_path):
    command = ("segment", clip / "video.mkv", "--quality", "fast", "--store", store, "--out", tmp_path, "--quiet")
    options = ("--start", "3", "--end", "9", "--every", "2", "--overlay-size", "video", "--overlay", "contour")
    assert moseg(*command, *options).code == 0
    with av.open(str(tmp_path / "overlay.mp4")) as container:
        shown = [frame.to_ndarray(format="gray").mean() for frame in container.decode(video=0)]
    means = [np.asarray(Image.open(clip / "frames" / f"{number:05d}.png")).mean() for number in (3, 5, 7)]
    np.testing.assert_allclose(shown, means, atol=3)


def test_python_takes_the_same_words_for_paths_and_arrays(clip, store):
    given = {"start": "0.2s", "end": 9, "fps": FPS, "quality": "fast", "store": store, "progress": False}
    video = python.segment_video(clip / "video.mkv", **given)
    array = np.stack([*VideoFile(str(clip / "video.mkv"), 1000).read()])
    arrays = python.segment_video(array, **given)
    assert video.num_frames == arrays.num_frames == 7
    np.testing.assert_array_equal([*video.frames()], [*arrays.frames()])
    with pytest.raises(InputError, match=r"neither a frame nor a time in start"):
        python.segment_video(clip / "video.mkv", start="4.5", store=store)
    with pytest.raises(InputError, match=r"expected fps"):
        python.segment_video(array, start="4.5s", store=store)


def test_after_a_gap_in_the_times_no_frames_are_caught_up():
    times = [0.0, 0.1, 5.0, 5.1, 5.2, 5.3, 6.05]
    assert list(FrameRange(every=Position(1.0, True)).choose(times)) == [0, 2, 6]


@pytest.mark.parametrize(
    ("every", "rate"), [(Position(2, False), 12.5), (Position(0.5, True), 2.0), (Position(0.01, True), 25.0)]
)
def test_what_is_thinned_plays_as_fast_as_the_whole(every, rate):
    assert FrameRange(every=every).thinned_rate(25.0) == pytest.approx(rate)
