"""The stored run that a folder of results is opened with, among others of the same video."""

import shutil
from contextlib import ExitStack

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.corrections import Corrections
from moseg.schemas.errors import InputError
from moseg.store import open_store
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.corrections_file import spell_corrections
from moseg.workflows.exports.motion_json import read_motion
from moseg.workflows.view.opened import ExportChoices
from moseg.workflows.view.opening import run_opening
from moseg.workflows.view.run_of_folder import find_run_of
from moseg.workflows.view.stored_runs import read_run

OPTIONS = ("--section-length", "4", "--set", "sections.overlap=2", "--keep-cues", "--quiet", "--overlay", "none")
LARGE_ALONE = ("--set", "moving_objects.min_area=0.0545")
"""Leaves out one of the two squares."""


@pytest.fixture
def segment(moseg, tmp_path):
    """Return a function that segments frames into a folder of its own, with one store, and returns folder and run."""

    def call(frames, name, *options):
        arguments = ("--out", tmp_path / name, "--store", tmp_path / "store", *OPTIONS, *options)
        assert moseg("segment", frames, *arguments).code == 0
        return tmp_path / name, read_run(_store(tmp_path), "latest").status.run_id

    return call


def _store(tmp_path):
    return open_store(str(tmp_path / "store"), create=False)


def _found(tmp_path, folder):
    return find_run_of(_store(tmp_path), folder, read_motion(folder / "motion.json")).status.run_id


@pytest.fixture
def still(tmp_path):
    """Return a folder of eight frames in which nothing moves."""
    (tmp_path / "still").mkdir()
    rng = np.random.default_rng(0)
    scene = rng.integers(0, 253, (48, 64, 3), np.uint8)
    for index in range(8):
        # With noise, so that each part is a run of its own.
        Image.fromarray(scene + rng.integers(0, 3, scene.shape, np.uint8)).save(tmp_path / "still" / f"{index:05d}.png")
    return tmp_path / "still"


def test_a_corrected_folder_is_opened_with_the_settings_of_its_run(segment, segmented, tmp_path):
    first, run = segment(segmented.frames, "A", "--rename", "2=bear")
    second, later = segment(segmented.frames, "B", *LARGE_ALONE)
    assert len(read_motion(second / "motion.json").objects) < len(read_motion(first / "motion.json").objects)
    assert (_found(tmp_path, first), _found(tmp_path, second)) == (run, later)


def test_a_part_of_a_folder_of_frames_is_opened_with_its_run(segment, segmented, tmp_path):
    first, run = segment(segmented.frames, "P1", "--start", "0", "--end", "5", "--rename", "1=first")
    second, later = segment(segmented.frames, "P2", "--start", "5", "--end", "10")
    assert (_found(tmp_path, first), _found(tmp_path, second)) == (run, later)


def test_a_part_in_which_nothing_moves_is_opened_with_its_run(segment, still, tmp_path):
    first, run = segment(still, "P1", "--end", "4")
    second, later = segment(still, "P2", "--start", "4")
    assert not read_motion(first / "motion.json").objects
    assert (_found(tmp_path, first), _found(tmp_path, second)) == (run, later)


def test_corrections_of_the_page_lead_to_the_run_that_they_are_of(segment, segmented, tmp_path):
    folder, run = segment(segmented.frames, "A")
    base = read_run(_store(tmp_path), run)
    segment(segmented.frames, "B", *LARGE_ALONE)
    edits = [{"drop": 1}, {"rename": {"object": 2, "name": "bear"}}]
    summary = read_motion(folder / "motion.json")
    with ExitStack() as stack:
        settings = RunSettings(str(tmp_path / "store"), quiet=True)
        opened = run_opening(base, folder, settings, summary)(stack)
        # The file of corrections has them as soon as they are made, before any is exported.
        (folder / "corrections.yaml").write_text(spell_corrections(Corrections(edits=edits[:1])))
        assert _is_like(find_run_of(_store(tmp_path), folder, summary), base)
        opened.correct(Corrections(edits=edits[:1]))
        opened.write(ExportChoices(overlay="none"))
    (folder / "corrections.yaml").write_text(spell_corrections(Corrections(edits=edits)))
    found = find_run_of(_store(tmp_path), folder, read_motion(folder / "motion.json"))
    assert _is_like(found, base)


def test_masks_of_corrections_that_were_taken_back_belong_to_a_run_only_without_a_choice(segment, segmented, tmp_path):
    folder, run = segment(segmented.frames, "A")
    for path in (folder / "masks").iterdir():
        Image.open(path).transpose(Image.Transpose.ROTATE_180).save(path)
    with pytest.raises(InputError, match="the results behind these masks are not stored"):
        _found(tmp_path, folder)
    (folder / "corrections.yaml").write_text(spell_corrections(Corrections(edits=[{"drop": 1}])))
    assert _found(tmp_path, folder) == run
    segment(segmented.frames, "B", *LARGE_ALONE)
    with pytest.raises(InputError, match="the results behind these masks are not stored"):
        _found(tmp_path, folder)


def _is_like(run, other):
    return (run.uncorrected, run.leaves.frames) == (other.uncorrected, other.leaves.frames)


def test_an_object_that_was_painted_belongs_to_its_run(segment, segmented, tmp_path):
    painted = [{"paint": {"object": 9, "frame": 8, "strokes": [{"radius": 5, "points": [[20, 20]]}]}}]
    file = tmp_path / "paint.yaml"
    file.write_text(spell_corrections(Corrections(edits=painted)))
    folder, run = segment(segmented.frames, "A", "--corrections", file)
    segment(segmented.frames, "B", *LARGE_ALONE)
    # A run of five frames has no frame 8.
    segment(segmented.frames, "C", "--end", "5")
    assert _found(tmp_path, folder) == run


def test_results_of_given_cues_are_opened_without_their_folders(segment, segmented, tmp_path):
    masks, flow = tmp_path / "masks", tmp_path / "flow"
    shutil.copytree(segmented.frames.parent / "masks", masks)
    for direction in ("forward", "backward"):
        (flow / direction).mkdir(parents=True)
        for index in range(9):
            np.save(flow / direction / f"{index:05d}.npy", np.zeros((96, 128, 2), np.float32))
    folder, run = segment(segmented.frames, "A", "--proposals", f"folder:{masks}", "--flow", f"folder:{flow}")
    shutil.rmtree(masks)
    shutil.rmtree(flow)
    summary = read_motion(folder / "motion.json")
    base = read_run(_store(tmp_path), run)
    for found in (find_run_of(_store(tmp_path), folder, summary), base):
        with ExitStack() as stack:
            settings = RunSettings(str(tmp_path / "store"), quiet=True)
            opened = run_opening(found, tmp_path / "out", settings, summary)(stack)
            assert opened.first.identities == tuple(each.identity for each in summary.objects)
            # Of the depth that was not given there is no folder either.
            with pytest.raises(InputError, match=r"a folder and its use disagree in --depth"):
                opened.correct(Corrections(settings={"depth.method": "folder"}))
            opened.write(ExportChoices(overlay="none"))
        for path in (folder / "masks").iterdir():
            assert (tmp_path / "out" / "masks" / path.name).read_bytes() == path.read_bytes()
