"""A tiny data set on disk, the command line in this process, and a store in which the data set was evaluated once."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, settings

# No example fails for its time, and each run tries the same ones: what passes on one machine passes on any.
settings.register_profile("search", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("same", settings.get_profile("search"), derandomize=True, database=None)
settings.load_profile("same")

NUM_FRAMES, HEIGHT, WIDTH = 10, 96, 128


class Ran(NamedTuple):
    """How a command ended and what it printed."""

    code: int
    out: str
    err: str


class Evaluation(NamedTuple):
    """A data set, a store, and what evaluated the one into the other."""

    root: Path
    store: Path
    arguments: tuple[str, ...]
    report: dict


def _write_image(path: Path, image: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(cv2.imencode(path.suffix, image)[1].tobytes())


def _write_squares(folder: Path, num_frames: int = NUM_FRAMES, seed: int = 0) -> Path:
    rng = np.random.default_rng(seed)

    def texture(height, width, brightness):
        noise = rng.integers(0, 256, (height, width, 3)).astype(np.uint8)
        return cv2.GaussianBlur(noise, (0, 0), 1.2) // 2 + np.uint8(brightness)

    backdrop = texture(HEIGHT, WIDTH + num_frames, 60)
    squares = texture(26, 26, 100), texture(22, 30, 120)
    for number in range(num_frames):
        image = backdrop[:, number : number + WIDTH].copy()
        labels = np.zeros((HEIGHT, WIDTH), np.uint8)
        corners = ((12, 14 + 3 * number), (28 + 3 * number, 84 - number))
        for label, ((y, x), square) in enumerate(zip(corners, squares, strict=True), start=1):
            height, width = square.shape[:2]
            image[y : y + height, x : x + width] = square
            labels[y : y + height, x : x + width] = label
        _write_image(folder / "frames" / f"{number:05d}.png", image)
        _write_image(folder / "masks" / f"{number:05d}.png", labels)
    return folder


@pytest.fixture(scope="session")
def write_image() -> Callable[[Path, np.ndarray], None]:
    """Writes a grey or BGR array to a path, its folders made."""
    return _write_image


@pytest.fixture(scope="session")
def write_squares() -> Callable[..., Path]:
    """Writes ``frames`` and ``masks`` of two textured squares that move, each in its way, over a panning backdrop."""
    return _write_squares


@pytest.fixture(scope="session")
def squares(tmp_path_factory) -> Path:
    """Root of a data set of kind ``folder`` with the single sequence ``squares``."""
    root = tmp_path_factory.mktemp("data")
    _write_squares(root / "squares")
    return root


@pytest.fixture
def in_empty_folder(tmp_path, monkeypatch) -> None:
    """Defaults such as ``.moseg/store`` and ``out`` fall into a folder of the test's own; no data set is known."""
    (tmp_path / "cwd").mkdir()
    monkeypatch.chdir(tmp_path / "cwd")
    monkeypatch.delenv("MOSEG_DATA", raising=False)


@pytest.fixture
def moseg(capsys) -> Callable[..., Ran]:
    """Runs a `moseg` command in this process."""
    from moseg.workflows.cli.app import run

    def call(*arguments) -> Ran:
        capsys.readouterr()
        code = run([str(argument) for argument in arguments])
        return Ran(code, *capsys.readouterr())

    return call


@pytest.fixture(scope="session")
def evaluated(squares, tmp_path_factory) -> Evaluation:
    """The squares evaluated in sections of four frames. Tests that damage the store take `evaluated_copy`."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("evaluated")
    arguments = ("eval", "--dataset", "folder", "--root", str(squares), "--quiet", "--section-length", "4")
    arguments += ("--set", "sections.overlap=2")
    assert run([*arguments, "--store", str(folder / "store"), "--json", str(folder / "report.json")]) == 0
    report = json.loads((folder / "report.json").read_text())
    return Evaluation(squares, folder / "store", arguments, report)


@pytest.fixture
def evaluated_copy(evaluated, tmp_path) -> Evaluation:
    """The same with a store of the test's own."""
    shutil.copytree(evaluated.store, tmp_path / "store")
    return evaluated._replace(store=tmp_path / "store")
