"""Masks and depth of a whole folder of frames are taken for a part of it, by the names of the frames."""

import shutil

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.api import segment_video

START, END = 2, 6
CONFIG = {"sections.length": 4, "sections.overlap": 2}


@pytest.fixture
def cues(squares, tmp_path):
    """Folders of masks and of depth, one for each of ten frames."""
    shutil.copytree(squares / "squares" / "masks", tmp_path / "masks")
    (tmp_path / "depth").mkdir()
    for number in range(10):
        np.save(tmp_path / "depth" / f"{number:05d}.npy", np.full((96, 128), 1.0 + number, np.float32))
    return {"proposals": tmp_path / "masks", "depth": tmp_path / "depth"}


@pytest.fixture
def segment(squares, tmp_path):
    frames = squares / "squares" / "frames"
    return lambda **more: segment_video(frames, CONFIG, store=tmp_path / "store", progress=False, **more)


def test_files_of_the_chosen_frames_are_taken(cues, segment):
    whole, part = segment(**cues), segment(**cues, start=START, end=END)
    assert part.num_frames == END - START
    np.testing.assert_array_equal(part.labels > 0, whole.labels[START:END] > 0)
    for frame in range(part.num_frames):
        np.testing.assert_array_equal(part.cue("inverse_depth", frame), whole.cue("inverse_depth", START + frame))


def test_a_file_of_no_frame_is_named_as_before(cues, segment):
    shutil.copy(cues["proposals"] / "00000.png", cues["proposals"] / "extra.png")
    with pytest.raises(InputError, match=r"mask without a frame in .*extra\.png"):
        segment(**cues, start=START, end=END)


def test_files_of_other_frames_alone_are_reported(cues, segment):
    for number in range(START, END):
        (cues["proposals"] / f"{number:05d}.png").unlink()
    with pytest.raises(InputError, match=r"no file of the chosen part in .*masks; got 6 files of other frames"):
        segment(**cues, start=START, end=END)
