from types import MappingProxyType

import numpy as np
import pytest
from PIL import Image

from moseg.workflows.api import segment_video
from moseg.workflows.api.open_run import open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.pipeline_choices import PipelineChoices

CONFIG = MappingProxyType({"sections.length": 4, "sections.overlap": 2})
SETTINGS = [word for name, value in CONFIG.items() for word in ("--set", f"{name}={value}")]


@pytest.fixture(scope="session")
def config():
    """Return parameters by which the squares have three sections."""
    return dict(CONFIG)


@pytest.fixture(scope="session")
def several_edits():
    """Return edits of the squares of three kinds; `several_options` are the same."""
    return [{"split": {"object": 2, "frame": 5, "into": 4}}, {"rename": {"object": 4, "name": "late"}}, {"drop": 1}]


@pytest.fixture(scope="session")
def several_options():
    """Return options of the command line that mean `several_edits`."""
    return ["--split", "2@5:4", "--rename", "4=late", "--drop", "1"]


@pytest.fixture(scope="session")
def frames(squares):
    return squares / "squares" / "frames"


@pytest.fixture(scope="module")
def store(tmp_path_factory, frames):
    """Return a store that has the squares' result, with its cues."""
    folder = tmp_path_factory.mktemp("corrections") / "store"
    segment_video(frames, dict(CONFIG), store=folder, progress=False, keep_cues=True)
    return folder


@pytest.fixture
def segment(moseg, frames, store, in_empty_folder):
    """Return a function that runs `moseg segment` on the squares with options."""

    def call(*options, out="out"):
        return moseg("segment", frames, "--out", out, "--store", store, "--quiet", "--keep-cues", *SETTINGS, *options)

    return call


@pytest.fixture
def correct(frames, store):
    """Return a function from corrections to the squares' result."""

    def call(corrections=None):
        return segment_video(frames, dict(CONFIG), store=store, progress=False, keep_cues=True, corrections=corrections)

    return call


@pytest.fixture
def opened(frames, store):
    """Return a function that opens a run on the squares, or a copy of them, for corrections."""

    def call(video=frames, store=store):
        return open_run(video, RunSettings(str(store), quiet=True), PipelineChoices(dict(CONFIG)))

    return call


@pytest.fixture
def read_masks():
    """Return a function that reads the masks (T, H, W) that a run wrote into a folder."""
    return lambda folder: np.stack([np.asarray(Image.open(path)) for path in sorted((folder / "masks").iterdir())])
