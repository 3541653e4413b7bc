"""A run that is opened without its video keeps which frames of it were read, in what it writes and corrects."""

import os
import shutil
from contextlib import ExitStack

import pytest

from moseg.schemas.corrections import Corrections
from moseg.schemas.events import VideoFrames
from moseg.store import open_store
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.cli.app import run
from moseg.workflows.config.corrections_file import read_corrections
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import read_motion
from moseg.workflows.sources import ImageFiles
from moseg.workflows.view.opened import ExportChoices
from moseg.workflows.view.opening import run_opening
from moseg.workflows.view.run_of_folder import find_run_of
from moseg.workflows.view.stored_runs import read_run

OPTIONS = ("--section-length", "4", "--set", "sections.overlap=2", "--keep-cues", "--quiet")
PARTS = {"clip.mp4": ("--start", "1", "--every", "2"), "frames": ("--start", "3")}
WORDS = {"clip.mp4": "5 frames, 1 to 9", "frames": "7 frames, 00003.png to 00009.png"}


def _segment(folder, name, out, *part):
    arguments = ("segment", folder / name, *part, "--out", folder / out, "--store", folder / f"{name}-db", *OPTIONS)
    assert run([*map(str, arguments)]) == 0


@pytest.fixture(scope="module")
def parts(segmented, tmp_path_factory):
    """Return a folder with a part of a video and of a folder of frames, each segmented into its own store."""
    folder = tmp_path_factory.mktemp("parts")
    shutil.copy(segmented.out / "overlay.mp4", folder / "clip.mp4")
    shutil.copytree(segmented.frames, folder / "frames")
    for name, part in PARTS.items():
        _segment(folder, name, f"{name}-out", *part)
    return folder


@pytest.fixture
def write(parts):
    """Return a function that opens a run as the page does, writes it with a correction, and returns what it wrote."""

    def call(name, out, run, summary=None):
        settings = RunSettings(str(parts / f"{name}-db"), quiet=True)
        with ExitStack() as stack:
            opened = run_opening(run, out, settings, summary)(stack)
            opened.correct(Corrections(edits=[{"drop": opened.first.identities[0]}]))
            opened.write(ExportChoices(overlay="none"))
        assert read_corrections(str(out / "corrections.yaml")).part == opened.part
        return read_motion(out / "motion.json"), opened.part

    return call


def _read_run(parts, name, run_id="latest"):
    return read_run(open_store(str(parts / f"{name}-db"), create=False), run_id)


@pytest.mark.parametrize("name", PARTS)
def test_a_part_that_is_opened_by_its_run_stays_that_part(parts, write, name, tmp_path):
    expected = read_motion(parts / f"{name}-out" / "motion.json")
    written, part = write(name, tmp_path / "out", _read_run(parts, name))
    assert (written.video, written.frames, written.numbers) == (expected.video, expected.frames, expected.numbers)
    assert (expected.frames or expected.numbers) is not None
    assert part == WORDS[name]
    # What has been written is another run where something was computed: it opens in the same way.
    again, part = write(name, tmp_path / "again", _read_run(parts, name))
    assert (again.frames, again.numbers, part) == (expected.frames, expected.numbers, WORDS[name])


@pytest.mark.parametrize("name", PARTS)
def test_a_part_that_is_opened_by_its_folder_stays_that_part(parts, write, name, tmp_path):
    shutil.copytree(parts / f"{name}-out", tmp_path / "out")
    summary = read_motion(tmp_path / "out" / "motion.json")
    store = open_store(str(parts / f"{name}-db"), create=False)
    written, part = write(name, tmp_path / "out", find_run_of(store, tmp_path / "out", summary), summary)
    assert (written.frames, written.numbers, part) == (summary.frames, summary.numbers, WORDS[name])


@pytest.mark.parametrize("name", PARTS)
def test_the_frames_of_a_run_of_an_earlier_version_are_those_of_its_results(parts, write, name, tmp_path):
    run = _read_run(parts, name)._replace(video_frames=None)
    shutil.copytree(parts / f"{name}-out", tmp_path / "out")
    expected = read_motion(tmp_path / "out" / "motion.json")
    written, _ = write(name, tmp_path / "out", run)
    assert (written.frames, written.numbers) == (expected.frames, expected.numbers)
    written, part = write(name, tmp_path / "elsewhere", run)
    assert (written.frames, written.numbers, part) == (None, None, None)


def test_a_corrected_folder_is_not_opened_with_a_run_of_another_part(parts, tmp_path):
    copy = tmp_path / "parts"
    shutil.copytree(parts, copy)
    run, folder = _read_run(copy, "clip.mp4"), copy / "clip.mp4-out"
    summary = read_motion(folder / "motion.json")
    store = open_store(str(copy / "clip.mp4-db"), create=False)
    _segment(copy, "clip.mp4", "other", "--end", "5")
    assert _read_run(copy, "clip.mp4").numbers == (0, 1, 2, 3, 4)
    assert find_run_of(store, folder, summary).leaves == run.leaves


def test_the_log_of_a_whole_video_says_that_it_is_whole(segmented):
    run = read_run(open_store(str(segmented.store), create=False), "latest")
    assert run.video_frames == VideoFrames(names=tuple(f"{number:05d}.png" for number in range(10)))


def test_names_that_json_cannot_hold_are_not_in_the_log(tmp_path):
    path = tmp_path / os.fsdecode(b"\xff.png")
    path.write_bytes(b"")
    assert FrameOrigin(None, ImageFiles((str(path),), 640)).recorded() is None
