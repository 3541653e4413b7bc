"""The squares segmented once by the command line, and by `segment_video` from the same store."""

from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import pytest

from moseg.workflows.api import MotionSegmentation, segment_video

CONFIG = {"sections.length": 4, "sections.overlap": 2}


class Segmented(NamedTuple):
    """A folder of frames, the store and the folder of the command line, and the same video by `segment_video`."""

    frames: Path
    store: Path
    out: Path
    result: MotionSegmentation


@pytest.fixture(scope="session")
def config() -> dict[str, int]:
    """Parameters that differ from the defaults."""
    return CONFIG


@pytest.fixture(scope="session")
def segmented(squares, tmp_path_factory) -> Segmented:
    """Tests that write to the store take another."""
    from moseg.workflows.cli.app import run

    folder, frames = tmp_path_factory.mktemp("segmented"), squares / "squares" / "frames"
    settings = [argument for name, value in CONFIG.items() for argument in ("--set", f"{name}={value}")]
    store, out = folder / "store", folder / "out"
    assert run(["segment", str(frames), "--out", str(out), "--store", str(store), "--quiet", *settings]) == 0
    return Segmented(frames, store, out, segment_video(frames, CONFIG, store=store, progress=False))


@pytest.fixture(scope="session")
def pixels(squares) -> np.ndarray:
    """The same frames as an array, uint8 (frame, y, x, rgb)."""
    paths = sorted((squares / "squares" / "frames").iterdir())
    return np.stack([cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB) for path in paths])
