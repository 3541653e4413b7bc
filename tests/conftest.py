"""Fixtures: a tiny data set on disk, the command line in this process, and a store with one evaluation of the data."""

import gc
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import pytest
import threadpoolctl
from hypothesis import HealthCheck, settings

# No deadline, and the same examples in each run, so that results do not depend on the machine.
settings.register_profile("search", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("same", settings.get_profile("search"), derandomize=True, database=None)
settings.load_profile("same")

# Below the folder in which a test runs, in its commands and their processes: never in the user's cache folder.
os.environ["MOSEG_STORE"] = ".moseg/store"

NUM_FRAMES, HEIGHT, WIDTH = 10, 96, 128
MEMORY_FOLDER = Path("/dev/shm")
MEMORY_BYTES = 8 * 2**30
"""Free memory that the folder must have, far more than a run writes; files of tests that pass are removed."""


class Ran(NamedTuple):
    """Exit code and output of a command."""

    code: int
    out: str
    err: str


class Evaluation(NamedTuple):
    """Evaluation of a data set into a store, with its command and report."""

    root: Path
    store: Path
    arguments: tuple[str, ...]
    report: dict


def pytest_configure() -> None:
    """Keep the tests' files in memory where there is room and no folder was chosen: they are many and small."""
    if "TMPDIR" not in os.environ and MEMORY_FOLDER.is_dir() and shutil.disk_usage(MEMORY_FOLDER).free > MEMORY_BYTES:
        os.environ["TMPDIR"] = tempfile.tempdir = str(MEMORY_FOLDER)


def pytest_collection_finish() -> None:
    """Bind libraries to one thread, because the workers of pytest use all cores, and exclude the modules and tests
    from garbage collection: they stay until the end, and to visit them takes half a second."""
    cv2.setNumThreads(1)
    threadpoolctl.threadpool_limits(1)
    if "torch" in sys.modules:
        sys.modules["torch"].set_num_threads(1)
    gc.collect()
    gc.freeze()


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
    """Return a function that writes a grey or BGR array to a path and creates its folders."""
    return _write_image


@pytest.fixture(scope="session")
def write_squares() -> Callable[..., Path]:
    """Return a function that writes ``frames`` and ``masks`` of two moving squares over a panning backdrop."""
    return _write_squares


@pytest.fixture(scope="session")
def squares(tmp_path_factory) -> Path:
    """Return the root of a data set of kind ``folder`` with the single sequence ``squares``."""
    root = tmp_path_factory.mktemp("data")
    _write_squares(root / "squares")
    return root


@pytest.fixture
def in_empty_folder(tmp_path, monkeypatch) -> None:
    """Run in an empty folder, which then has defaults such as ``.moseg/store`` and ``out``; unset the data roots."""
    (tmp_path / "cwd").mkdir()
    monkeypatch.chdir(tmp_path / "cwd")
    monkeypatch.delenv("MOSEG_DATA", raising=False)


@pytest.fixture
def moseg(capsys) -> Callable[..., Ran]:
    """Return a function that runs a `moseg` command in this process."""
    from moseg.workflows.cli.app import run

    def call(*arguments) -> Ran:
        capsys.readouterr()
        code = run([str(argument) for argument in arguments])
        return Ran(code, *capsys.readouterr())

    return call


@pytest.fixture(scope="session")
def evaluated(squares, tmp_path_factory) -> Evaluation:
    """Return the evaluation of the squares in sections of four frames; tests that damage it use `evaluated_copy`."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("evaluated")
    arguments = ("eval", "--dataset", "folder", "--root", str(squares), "--quiet", "--section-length", "4")
    arguments += ("--set", "sections.overlap=2")
    assert run([*arguments, "--store", str(folder / "store"), "--json", str(folder / "report.json")]) == 0
    report = json.loads((folder / "report.json").read_text())
    return Evaluation(squares, folder / "store", arguments, report)


@pytest.fixture
def evaluated_copy(evaluated, tmp_path) -> Evaluation:
    """Return the same evaluation with a copy of its store."""
    shutil.copytree(evaluated.store, tmp_path / "store")
    return evaluated._replace(store=tmp_path / "store")
