"""Runs on videos with a sign drawn into them: it is not found, and what is shown is the video as it is."""

import cv2
import numpy as np
import pytest

import moseg
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.store import open_store
from moseg.tasks.screen_graphics import graphics_mask
from moseg.workflows.api.open_run import open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.reports.subject import read_subject
from moseg.workflows.runlog.status import list_runs

NUM_FRAMES, HEIGHT, WIDTH, PAN, PILLAR = 12, 96, 128, 3, 20
BARS = BlackBars(left=PILLAR)
CONFIG = {"proposal_source": "saliency"}
SIGN = np.s_[22:46, 84:120]
IN_SIGN = np.s_[:, *SIGN]
PLACE = "42 x 30 px at 81, 19"
"""Of the sign with 3 px around it, within which edges belong to it."""
LEFT_OUT = f"graphics in the frames ({PLACE}) are left out: what is around them stands for them"


def _texture(height, width, seed):
    noise = np.random.default_rng(seed).integers(0, 256, (height, width, 3)).astype(np.uint8)
    return cv2.GaussianBlur(noise, (0, 0), 1.2)


def _paint():
    """Return frames of two squares over a backdrop that pans by 3 px a frame, and their masks."""
    backdrop, squares = _texture(HEIGHT, WIDTH + PAN * NUM_FRAMES, 0), (_texture(26, 26, 1), _texture(24, 30, 2))
    frames, masks = np.zeros((NUM_FRAMES, HEIGHT, WIDTH, 3), np.uint8), np.zeros((NUM_FRAMES, HEIGHT, WIDTH), np.uint8)
    for number, (frame, mask) in enumerate(zip(frames, masks, strict=True)):
        frame[:] = backdrop[:, PAN * number : PAN * number + WIDTH]
        corners = (22, 24 + 2 * number), (62, 84 + number // 2)
        for label, ((y, x), square) in enumerate(zip(corners, squares, strict=True), start=1):
            place = np.s_[y : y + square.shape[0], x : x + square.shape[1]]
            frame[place], mask[place] = square, label
    return frames, masks


def _draw(frames):
    """Return frames with a red sign that has white letters, beside the way of the squares."""
    drawn = frames.copy()
    drawn[:, *SIGN] = 200, 30, 30
    for stroke in np.s_[27:31, 89:105], np.s_[31:41, 95:99], np.s_[27:41, 108:112]:
        drawn[:, *stroke] = 255
    return drawn


def _hide_left(frames):
    pillared = frames.copy()
    pillared[:, :, :PILLAR] = 0
    return pillared


@pytest.fixture(scope="module")
def clip():
    """Return the frames without the sign, and the masks of the squares."""
    return _paint()


@pytest.fixture(scope="module")
def film(clip):
    """Return the frames with the sign."""
    return _draw(clip[0])


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """Return the folder of the store of all runs."""
    return tmp_path_factory.mktemp("graphics") / "store"


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


@pytest.fixture(scope="module")
def unfilled(segment, film):
    """Return the result of the film with the sign as scene."""
    return segment(film, {"screen_graphics.fill": False})


@pytest.fixture(scope="module")
def pillared(segment, film, tmp_path_factory):
    """Return the result of the film with a pillar, and its store, which keeps the cues."""
    store = tmp_path_factory.mktemp("pillared") / "store"
    return segment(_hide_left(film), store=store, keep_cues=True), store


def _overlap(labels, masks):
    found, true = labels > 0, masks > 0
    return (found & true).sum() / (found | true).sum()


def _filled(folder):
    return [*open_store(str(folder), create=False).refs("filled_frame")]


def test_the_squares_are_found_and_the_sign_is_not(found, clip):
    assert len(found.objects) == 2 and _overlap(found.labels, clip[1]) > 0.85
    assert not found.labels[IN_SIGN].any()


def test_as_scene_the_sign_is_found(unfilled, clip):
    assert (unfilled.labels[IN_SIGN] > 0).mean() > 0.5 and _overlap(unfilled.labels, clip[1]) < 0.75


def test_the_first_line_names_the_sign_and_where_it_is(found, unfilled):
    assert found.look_at[0] == LEFT_OUT
    assert unfilled.look_at[0] == f"graphics in the frames ({PLACE}) count as scene: they may be taken for objects"


def test_no_track_is_in_the_sign(segment, film, tmp_path):
    segment(film, {"proposal_source": "tracks"}, store=tmp_path / "store")
    opened = open_store(str(tmp_path / "store"), create=False)
    in_sign = np.zeros((HEIGHT, WIDTH), bool)
    in_sign[SIGN] = True
    refs = [*opened.refs("dense_tracks")]
    assert refs
    for ref in refs:
        points, visible = opened.read(ref, "points"), opened.read(ref, "visible")
        x, y = np.rint(points[visible]).astype(int).T
        assert len(x) and not in_sign[y, x].any() and not points[~visible].any()


def test_frames_that_are_shown_are_those_of_the_video(found, film, store):
    assert all(np.array_equal(*pair) for pair in zip(found.frames(), film, strict=True))
    with open_run(film, RunSettings(str(store), quiet=True), PipelineChoices(CONFIG), name="film") as run:
        run.apply([])
        assert np.array_equal(run.image(3), film[3])
        assert all(np.array_equal(run.labels(frame), found.labels[frame]) for frame in range(NUM_FRAMES))


def test_a_run_again_computes_nothing(found, segment, film):
    again = segment(film)
    assert again.store_use.computed == 0 and again.look_at == found.look_at


def test_workers_give_the_same_masks(found, segment, film, tmp_path):
    assert np.array_equal(segment(film, workers=2, store=tmp_path / "store").labels, found.labels)


def test_without_graphics_a_video_has_no_filled_frames(segment, clip, tmp_path):
    result = segment(clip[0], store=tmp_path / "store", keep_cues=True)
    assert len([*open_store(str(tmp_path / "store"), create=False).refs("screen_graphics")]) == 1
    assert not _filled(tmp_path / "store") and not any("graphics" in line for line in result.look_at)


def test_a_sign_beside_a_pillar_is_found_where_it_is(pillared):
    result, store = pillared
    assert result.look_at[:2] == (f"black bars ({PILLAR} px left) are left out: nothing is found in them", LEFT_OUT)
    opened = open_store(str(store), create=False)
    filled = [opened.manifest(ref).recipe.params for ref in _filled(store)]
    assert len(filled) == NUM_FRAMES
    for params in filled:
        assert params["bars"] == BARS._asdict()
        assert graphics_mask(ScreenGraphics(**params["graphics"]), (HEIGHT, WIDTH))[SIGN].all()


def test_beside_a_pillar_the_squares_are_found_and_nothing_else(pillared, clip):
    labels = pillared[0].labels
    assert len(pillared[0].objects) == 2 and _overlap(labels, clip[1]) > 0.85
    assert not labels[:, :, :PILLAR].any() and not labels[IN_SIGN].any()


def test_the_log_of_a_run_leads_to_the_same_filled_frames(pillared):
    opened = open_store(str(pillared[1]), create=False)
    (run,) = list_runs(opened)
    subject = read_subject(opened, run)
    leaves = subject.sequences[0].leaves
    assert leaves.graphics.parts and leaves.bars == BARS
    assert {*Nodes(leaves, subject.config).frames} == {*_filled(pillared[1])}


def test_a_pillar_that_counts_as_scene_does_not_hide_the_sign(segment, film, tmp_path):
    result = segment(_hide_left(film), {"black_bars.fill": False}, store=tmp_path / "store", keep_cues=True)
    assert "count as scene" in result.look_at[0] and result.look_at[1] == LEFT_OUT
    opened = open_store(str(tmp_path / "store"), create=False)
    assert not any("bars" in opened.manifest(ref).recipe.params for ref in _filled(tmp_path / "store"))


def test_with_all_as_scene_nothing_is_filled(segment, film, tmp_path):
    config = {"black_bars.fill": False, "screen_graphics.fill": False}
    result = segment(_hide_left(film), config, store=tmp_path / "store", keep_cues=True)
    assert not _filled(tmp_path / "store") and all("count as scene" in line for line in result.look_at[:2])
