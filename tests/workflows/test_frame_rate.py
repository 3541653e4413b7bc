"""The frame rate of overlay and summary: the given one, else the video's, by command and by call alike."""

import json
from fractions import Fraction

import av
import cv2
import numpy as np
import pytest

import moseg as python
from moseg.workflows.exports.outputs import MOTION, OVERLAY
from moseg.workflows.exports.write_overlay import write_overlay

OWN = 10


@pytest.fixture(scope="module")
def videos(tmp_path_factory):
    """Return a video of 10 frames per second, and a folder of its frames, which has no frame rate."""
    root = tmp_path_factory.mktemp("videos")
    backdrop = cv2.GaussianBlur(np.random.default_rng(0).integers(0, 256, (48, 80, 3)).astype(np.uint8), (0, 0), 1.2)
    frames = [backdrop[:, number : number + 64] for number in range(4)]
    (root / "frames").mkdir()
    for number, frame in enumerate(frames):
        cv2.imwrite(str(root / "frames" / f"{number:05d}.png"), frame)
    write_overlay(root / "video.mp4", frames, [np.zeros((48, 64), np.uint16)] * 4, OWN)
    return {"video": root / "video.mp4", "folder": root / "frames"}


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return tmp_path_factory.mktemp("rates") / "store"


@pytest.fixture
def by_command(moseg, store):
    """Return a function that segments by `moseg segment`."""

    def call(video, out, fps):
        asked = () if fps is None else ("--fps", fps)
        ran = moseg("segment", video, "--quality", "fast", "--store", store, "--out", out, "--quiet", *asked)
        assert (ran.code, ran.err) == (0, "")

    return call


@pytest.fixture
def by_call(store):
    """Return a function that segments by `moseg.segment_video`."""

    def call(video, out, fps):
        result = python.segment_video(video, quality="fast", store=store, fps=fps, progress=False)
        result.save(out)

    return call


def _rates(out):
    with av.open(str(out / OVERLAY)) as container:
        return Fraction(container.streams.video[0].average_rate), json.loads((out / MOTION).read_text())["fps"]


@pytest.mark.parametrize("way", ["by_command", "by_call"])
@pytest.mark.parametrize(
    ("kind", "asked", "expected"),
    [("video", None, OWN), ("video", 30, 30), ("folder", None, 24), ("folder", 30, 30), ("video", 12.5, 12.5)],
)
def test_the_given_frame_rate_overrides_that_of_the_video(request, videos, tmp_path, way, kind, asked, expected):
    request.getfixturevalue(way)(videos[kind], tmp_path / "out", asked)
    assert _rates(tmp_path / "out") == (Fraction(expected), expected)
