"""Runs on videos with black bars: nothing is found in them, and what is shown is the video as it is."""

import json

import cv2
import numpy as np
import pytest

import moseg
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.recipes import split_ref
from moseg.store import open_store
from moseg.workflows.api.open_run import open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.reports.subject import read_subject
from moseg.workflows.runlog.status import list_runs

NUM_FRAMES, LEFT, TOP = 8, 30, 10
CONFIG = {"proposal_source": "saliency"}
IN_BARS = np.s_[..., :LEFT]
SPOT = {"radius": 5, "points": [[12, 80]]}


def _show(frames):
    """Return frames whose left part, through which a square moves, is hidden by a bar."""
    barred = frames.copy()
    barred[:, :, :LEFT] = 0
    return barred


def _read(folder):
    return np.stack([cv2.imread(str(path))[..., ::-1] for path in sorted(folder.iterdir())])


@pytest.fixture(scope="module")
def clip(write_squares, tmp_path_factory):
    """Return the folder of frames and masks of two squares, of which one comes out of where the bar will be."""
    return write_squares(tmp_path_factory.mktemp("clip") / "squares", num_frames=NUM_FRAMES)


@pytest.fixture(scope="module")
def film(clip):
    """Return the frames with a bar."""
    return _show(_read(clip / "frames"))


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """Return the folder of the store of all runs."""
    return tmp_path_factory.mktemp("bars") / "store"


@pytest.fixture(scope="module")
def segment(store):
    """Return a function that segments frames."""

    def call(frames, config=(), **options):
        options = {"store": store, "progress": False, "name": "film", **options}
        return moseg.segment_video(frames, CONFIG | dict(config), **options)

    return call


@pytest.fixture(scope="module")
def found(segment, film):
    """Return the result of the film."""
    return segment(film)


def _overlap(labels, masks):
    found, true = labels > 0, masks > 0
    return (found & true).sum() / (found | true).sum()


def test_the_squares_are_found_in_the_picture_and_nothing_in_the_bar(found, clip):
    truth = np.stack([cv2.imread(str(path), 0) for path in sorted((clip / "masks").iterdir())])
    truth[IN_BARS] = 0
    assert not found.labels[IN_BARS].any()
    assert len(found.objects) == 2 and _overlap(found.labels, truth) > 0.9
    assert found.look_at[0] == f"black bars ({LEFT} px left) are left out: nothing is found in them"


def test_what_continues_into_the_filled_bar_is_cut_off(found, store):
    """Without that, the square that comes out of the bar would have pixels in it."""
    opened = open_store(str(store), create=False)
    masks = {
        opened.manifest(ref).recipe.params["method"]: opened.read(ref, "masks") for ref in opened.refs("proposals")
    }
    assert masks["saliency"][IN_BARS].any() and not masks["inside"][IN_BARS].any()


def test_frames_that_are_shown_are_those_of_the_video(found, film, tmp_path):
    assert all(np.array_equal(*pair) for pair in zip(found.frames(), film, strict=True))
    with open_run(film, RunSettings(str(tmp_path / "store"), quiet=True), PipelineChoices(CONFIG), name="film") as run:
        run.apply([])
        assert np.array_equal(run.image(3), film[3])
        assert all(np.array_equal(run.labels(frame), found.labels[frame]) for frame in range(NUM_FRAMES))


def test_filled_frames_are_let_go_of_unless_cues_are_kept(found, segment, film, store, tmp_path):
    assert not [*open_store(str(store), create=False).refs("filled_frame")]
    kept = segment(film, store=tmp_path / "store", keep_cues=True)
    assert len([*open_store(str(tmp_path / "store"), create=False).refs("filled_frame")]) == NUM_FRAMES
    assert np.array_equal(kept.labels, found.labels) and kept.cue("saliency", 2).shape


def test_a_run_again_computes_nothing(found, segment, film):
    again = segment(film)
    assert again.store_use.computed == 0 and again.look_at == found.look_at


def test_workers_give_the_same_masks(found, segment, film, tmp_path):
    assert np.array_equal(segment(film, workers=2, store=tmp_path / "store").labels, found.labels)


def test_the_edge_of_the_bar_is_no_corner_that_stands_still(segment, film, tmp_path):
    """Points are followed as they are in the picture without the bar, at whose edge corners stay where they are."""
    segment(film, {"proposal_source": "tracks"}, store=tmp_path / "store")
    opened = open_store(str(tmp_path / "store"), create=False)
    refs = [*opened.refs("dense_tracks")]
    assert refs
    for ref in refs:
        points, visible = opened.read(ref, "points"), opened.read(ref, "visible")
        assert visible.any() and points[visible][:, 0].min() >= LEFT + PipelineConfig().dense_tracks.border
        assert not points[~visible].any()
        in_backdrop = points[:, :, 1] > 80
        steps = np.diff(points[..., 0], axis=1)[visible[:, 1:] & visible[:, :-1] & in_backdrop[:, 1:]]
        # The camera pans by a pixel a frame.
        assert len(steps) and np.abs(steps + 1).max() < 0.5


def test_switched_off_the_bar_is_scene(segment, film, tmp_path):
    unfilled = segment(film, {"black_bars.fill": False}, store=tmp_path / "store")
    assert unfilled.look_at[0].startswith(f"black bars ({LEFT} px left) count as scene")
    refs = [*open_store(str(tmp_path / "store"), create=False).refs()]
    assert not any(split_ref(ref)[0] == "filled_frame" for ref in refs)


def test_without_bars_a_video_has_one_artifact_more_than_before(segment, clip, tmp_path):
    result = segment(_read(clip / "frames"), store=tmp_path / "store", keep_cues=True)
    opened = open_store(str(tmp_path / "store"), create=False)
    assert len([*opened.refs("black_bars")]) == 1 and not [*opened.refs("filled_frame")]
    assert not any("black bars" in line for line in result.look_at)


def test_strokes_may_lie_in_a_bar_and_reach_no_other_frame_in_it(segment, film):
    result = segment(film, corrections=[{"paint": {"object": 1, "frame": 2, "strokes": [SPOT]}}])
    in_bar = [bool(labels[IN_BARS].any()) for labels in result.labels]
    assert in_bar == [frame == 2 for frame in range(NUM_FRAMES)]
    assert result.labels[2, 80, 12] == 1


def test_bars_are_those_of_all_scenes(segment, film, write_squares, tmp_path):
    second = _show(_read(write_squares(tmp_path / "other", num_frames=6, seed=7) / "frames"))
    result = segment(np.concatenate([film, second]))
    assert "black bars" in result.look_at[0] and result.look_at[1].startswith(f"cut before frame {NUM_FRAMES}: ")
    assert not result.labels[IN_BARS].any() and result.labels[:NUM_FRAMES].any() and result.labels[NUM_FRAMES:].any()
    assert np.array_equal(next(iter(result.frames())), film[0])


def test_the_log_of_a_run_leads_to_the_same_filled_frames(segment, film, tmp_path):
    segment(film, store=tmp_path / "store", keep_cues=True)
    opened = open_store(str(tmp_path / "store"), create=False)
    (run,) = list_runs(opened)
    subject = read_subject(opened, run)
    leaves = subject.sequences[0].leaves
    assert leaves.bars.left == LEFT
    assert {*Nodes(leaves, subject.config).frames} == {*opened.refs("filled_frame")}


def test_a_damaged_filled_frame_is_made_again(segment, film, tmp_path):
    segment(film, store=tmp_path / "store", keep_cues=True)
    opened = open_store(str(tmp_path / "store"), create=False)
    lost = next(iter(opened.refs("filled_frame")))
    opened.remove(lost)
    segment(film, store=tmp_path / "store", keep_cues=True)
    assert opened.present([lost]) == {lost}


def test_the_command_says_that_bars_are_left_out(moseg, film, tmp_path):
    for number, image in enumerate(film):
        (tmp_path / "frames").mkdir(exist_ok=True)
        cv2.imwrite(str(tmp_path / "frames" / f"{number:05}.png"), image[..., ::-1])
    out = tmp_path / "out"
    ran = moseg("segment", tmp_path / "frames", "--out", out, "--store", tmp_path / "store", "--proposals", "saliency")
    line = f"black bars ({LEFT} px left) are left out: nothing is found in them"
    assert ran.code == 0 and f"look at: {line}" in ran.out + ran.err
    assert json.loads((out / "motion.json").read_text())["look_at"][0] == line
    masks = np.stack([cv2.imread(str(path)) for path in sorted((out / "masks").iterdir())])
    assert masks.any() and not masks[:, :, :LEFT].any()
