"""A tiny scene as frames, image folders and videos, and the command line with all that it prints, decoders in C
included."""

import os
import shutil
from pathlib import Path
from typing import NamedTuple

import av
import cv2
import numpy as np
import pytest
from PIL import Image

NUM_FRAMES, HEIGHT, WIDTH = 5, 48, 64


class Ran(NamedTuple):
    """How a command ended and what it printed."""

    code: int
    out: str
    err: str


def _scene(height: int, width: int) -> list[np.ndarray]:
    rng = np.random.default_rng(0)

    def texture(rows, columns):
        return cv2.GaussianBlur(rng.integers(0, 256, (rows, columns, 3)).astype(np.uint8), (0, 0), 1.2)

    side = max(1, min(height, width) // 3)
    backdrop, square = texture(height, width + NUM_FRAMES), texture(side, side)
    frames = []
    for number in range(NUM_FRAMES):
        frame = backdrop[:, number : number + width].copy()
        x = width // 8 + min(2 * number, max(0, width - side - width // 8))
        frame[height // 4 : height // 4 + side, x : x + side] = square[:, : width - x]
        frames.append(frame)
    return frames


def _stamps_of(folder: Path) -> dict[str, tuple[int, int]]:
    """Every file below a folder, with its size and the time at which it was written; none if there is no folder."""
    # `Path.rglob` takes ten times as long, for a store of thousands of files.
    paths = [os.path.join(parent, name) for parent, _, names in os.walk(folder) for name in names]
    states = {path: os.stat(path) for path in paths if os.path.isfile(path)}
    return {path: (state.st_size, state.st_mtime_ns) for path, state in states.items()}


@pytest.fixture(scope="session")
def scene():
    """Frames uint8 (y, x, rgb) of a textured square that moves over a panning backdrop."""
    return _scene


@pytest.fixture(scope="session")
def frames() -> list[np.ndarray]:
    """The scene at 64x48 px."""
    return _scene(HEIGHT, WIDTH)


@pytest.fixture
def write_folder(tmp_path, frames):
    """Writes frames to a folder as images by `save(image, path)`, Pillow's by default; returns the folder."""

    def write(name="frames", images=frames, save=None, suffix=".png"):
        folder = tmp_path / name
        folder.mkdir(parents=True)
        for number, image in enumerate(images):
            path = folder / f"{number:05d}{suffix}"
            if save is None:
                Image.fromarray(image).save(path)
            else:
                save(image, path)
        return folder

    return write


@pytest.fixture
def write_video(tmp_path, frames):
    """Writes RGB frames to a video; `times` are time stamps in 1/25 s, `set_up` may change the stream."""

    def write(
        name="video.mp4",
        images=frames,
        times=None,
        codec="libx264",
        pixels="yuv420p",
        set_up=None,
        muxer=None,
        **options,
    ):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        with av.open(str(path), "w", options=muxer or {}) as container:
            stream = container.add_stream(codec, rate=25, options=options)
            stream.height, stream.width = images[0].shape[:2]
            stream.pix_fmt = pixels
            if set_up is not None:
                set_up(stream)
            packets = []
            for number, image in enumerate(images):
                frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format="rgb24")
                frame.pts = number if times is None else times[number]
                packets.extend(stream.encode(frame))
            packets.extend(stream.encode(None))
            for number, packet in enumerate(packets[:-1] if times else ()):
                packet.duration = times[number + 1] - times[number]
            for packet in packets:
                container.mux(packet)
        return path

    return write


@pytest.fixture
def moseg(capfd):
    """Runs a `moseg` command in this process; what libraries print past Python is caught too."""
    from moseg.workflows.cli.app import run

    def call(*arguments) -> Ran:
        capfd.readouterr()
        code = run([str(argument) for argument in arguments])
        return Ran(code, *capfd.readouterr())

    return call


@pytest.fixture(scope="module")
def store(tmp_path_factory) -> Path:
    """One store for the tests of a module: what is refused must not harm what others have stored."""
    return tmp_path_factory.mktemp("shared") / "store"


@pytest.fixture
def segment(moseg, store, tmp_path, in_empty_folder):
    """Runs `moseg segment` at its quickest; returns how it ended."""

    def call(video, *options, out=None):
        target = tmp_path / "out" if out is None else out
        quick = ("--quality", "fast", "--quiet", "--store", store)
        return moseg("segment", *quick, "--out", target, *options, "--", video)

    return call


@pytest.fixture
def masks_of(segment, tmp_path):
    """Segments what must be accepted without a word on standard error; returns the masks, uint16 (frame, y, x)."""

    def call(video, *options):
        # The folder of one video is not that of another.
        shutil.rmtree(tmp_path / "out", ignore_errors=True)
        ran = segment(video, *options)
        assert (ran.code, ran.err) == (0, "")
        paths = sorted((tmp_path / "out" / "masks").iterdir())
        return np.stack([np.asarray(Image.open(path)).astype(np.uint16) for path in paths])

    return call


@pytest.fixture
def assert_refused():
    """Exit code 2, nothing on standard output, and one line on standard error with each of the words."""

    def check(ran, *words):
        assert ran.code == 2, ran.err
        assert ran.out == ""
        assert ran.err.startswith("moseg: "), ran.err
        assert ran.err.count("\n") == 1 and ran.err.endswith("\n"), ran.err
        for word in words:
            assert str(word) in ran.err

    return check


@pytest.fixture
def refuse(segment, assert_refused, store, tmp_path):
    """Segments what must be refused, with each of the words; what stood in the store and the folder still stands."""

    def call(video, *words, options=(), out=None):
        target = tmp_path / "out" if out is None else Path(out)
        kept = {store: _stamps_of(store), target: _stamps_of(target)}
        ran = segment(video, *options, out=target)
        assert_refused(ran, *words)
        found = {folder: _stamps_of(folder) for folder in kept}
        for folder, files in kept.items():
            now = found[folder]
            assert {path: now.get(path) for path in files} == files
            assert not [path for path in now if path.endswith(".part")]
        assert not set(found[target]) - set(kept[target])
        return ran.err

    return call
