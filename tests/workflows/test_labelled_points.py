"""A rendered clip in KT3DInsMoSeg's layout of labelled trajectories, evaluated and scored by the command line."""

import json
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from PIL import Image
from scipy.io import savemat

from moseg.tasks.synthetic import SCENES, RenderedScene, render_scene
from moseg.workflows.exports.draw_contact_sheet import draw_contact_sheet
from moseg.workflows.pipelines import contact_sheets

pytestmark = pytest.mark.usefixtures("in_empty_folder")

CLIP, NUM_FRAMES, FIRST_IMAGE = "Seq009_Clip01", 8, 105
MEASURES = ("P", "R", "F", "J", "J_objects")


class Clip(NamedTuple):
    """Root with images and trajectories, another root with images and masks, and the rendered scene."""

    points_root: Path
    masks_root: Path
    scene: RenderedScene


@pytest.fixture(scope="module")
def clip(tmp_path_factory, write_image) -> Clip:
    scene = render_scene(SCENES["two-motions"].model_copy(update={"num_frames": NUM_FRAMES, "points_per_object": 300}))
    points_root, masks_root = tmp_path_factory.mktemp("points"), tmp_path_factory.mktemp("masks")
    for frame, (image, moving) in enumerate(zip(scene.images, scene.moving, strict=True)):
        name = f"{frame + FIRST_IMAGE:010d}.png"
        for root in (points_root, masks_root):
            write_image(root / CLIP / "images" / name, image[..., ::-1])
        write_image(masks_root / CLIP / "masks" / name, moving.astype(np.uint8))
    _write_tracks(points_root / CLIP / f"{CLIP}_Tracks.mat", scene)
    return Clip(points_root, masks_root, scene)


def _write_tracks(path, scene):
    """Write the scene's exact tracks; label 1 of KT3DMoSeg is the background."""
    x, y = np.floor(scene.points + 0.5).astype(int).transpose(2, 0, 1)
    track, frame = np.nonzero(scene.visible)
    under = np.zeros(scene.visible.shape, int)
    under[track, frame] = scene.moving[frame, y[track, frame], x[track, frame]]
    # In its first frame a point is the centre of a pixel within its object.
    labels = under[np.arange(len(under)), scene.visible.argmax(axis=1)]
    # A point on an outline may lie in a pixel whose centre shows the surface behind the object.
    visible = scene.visible & (under == labels[:, None])
    assert np.count_nonzero(visible) > 0.99 * np.count_nonzero(scene.visible)
    homogeneous = np.concatenate([scene.points, np.ones((*visible.shape, 1))], axis=-1)
    sparse = np.where(visible[..., None], homogeneous, 0).astype(float).transpose(2, 0, 1)
    data = {"ySparse": sparse, "visibleSparse": visible.astype(np.uint8), "GtLabel": (labels + 1).astype(np.uint8)}
    savemat(path, {"Data": data}, do_compression=True)


def _write_predictions(folder, masks, write_image):
    for frame, mask in enumerate(masks):
        write_image(folder / CLIP / f"{frame + FIRST_IMAGE:010d}.png", mask.astype(np.uint8))
    return folder


@pytest.fixture
def score(moseg, write_image, tmp_path):
    """Return a function that scores masks (frame, y, x) against a root and returns the report and the output."""

    def call(root, masks):
        folder = _write_predictions(tmp_path / "saved", masks, write_image)
        data = ("--dataset", "kt3dinsmoseg", "--root", root, "--predictions", folder, "--sequences", CLIP)
        ran = moseg("score", *data, "--json", tmp_path / "report.json", "--quiet")
        assert (ran.code, ran.err) == (0, "")
        return json.loads((tmp_path / "report.json").read_text()), ran.out

    return call


@pytest.fixture
def run(moseg, tmp_path):
    """Return a function that runs a command on the clip with given masks of its moving objects."""

    def call(command, root, proposals, *options):
        data = ("--dataset", "kt3dinsmoseg", "--root", root, "--sequences", CLIP, "--store", tmp_path / "store")
        given = ("--proposals", f"folder:{proposals}", "--variant", "base", "--section-length", "4")
        ran = moseg(command, *data, *given, "--set", "sections.overlap=2", *options)
        assert (ran.code, ran.err) == (0, ""), ran.err
        return ran.out

    return call


def _only(report):
    (row,) = report["rows"]
    assert row["mean"] == row["sequences"][CLIP]
    return row["mean"]


def test_a_perfect_prediction_scores_a_hundred_and_the_report_counts_the_scored_points(clip, score):
    report, out = score(clip.points_root, clip.scene.moving)
    assert _only(report) == dict.fromkeys(MEASURES, 100)
    assert (report["dataset"], report["over"]) == ("kt3dinsmoseg", "points")
    assert "kt3dinsmoseg, saved, over points" in out
    assert "F-boundary" not in out
    report, out = score(clip.masks_root, clip.scene.moving)
    assert (report["over"], report["rows"][0]["mean"]["boundary_F"]) == ("pixels", 100)
    assert "over points" not in out
    assert "F-boundary" in out


def test_nothing_predicted_scores_nothing(clip, score):
    assert _only(score(clip.points_root, np.zeros_like(clip.scene.moving))[0]) == dict.fromkeys(MEASURES, 0)


def test_points_score_a_good_prediction_nearly_as_masks_do(clip, score):
    # A fifth of each object's height is missing: an error of area, not along outlines, where tracks are rare.
    predicted = clip.scene.moving.copy()
    for frame, moving in enumerate(clip.scene.moving):
        for label in np.unique(moving)[1:]:
            y = np.nonzero(moving == label)[0]
            cut = y.max() - (y.max() - y.min()) // 5
            predicted[frame, cut:][moving[cut:] == label] = 0
    dense = _only(score(clip.masks_root, predicted)[0])
    over_points = _only(score(clip.points_root, predicted)[0])
    assert 75 < dense["R"] < 95
    assert {name: over_points[name] for name in MEASURES} == pytest.approx({m: dense[m] for m in MEASURES}, abs=4)


def test_missed_and_false_objects_are_scored_at_the_points_on_them(clip, score):
    moving, objects = clip.scene.moving, clip.scene.objects
    missed, found = (label for label in np.unique(moving) if label)
    static = next(label for label in np.unique(objects) if label not in (0, missed, found))
    measured = _only(score(clip.points_root, np.where(np.isin(objects, (found, static)), objects, 0))[0])
    dense = _only(score(clip.masks_root, np.where(np.isin(objects, (found, static)), objects, 0))[0])
    assert 30 < measured["R"] < 70
    assert 30 < measured["P"] < 90
    assert measured["J_objects"] == pytest.approx(50)
    assert dense["J_objects"] == pytest.approx(50)


@pytest.mark.parametrize("options", [(), ("--set", "max_side=213")], ids=["full", "half"])
def test_an_evaluation_scores_at_the_points_as_saved_masks_do(clip, run, tmp_path, write_image, options):
    given = _write_predictions(tmp_path / "given", clip.scene.moving, write_image)
    out = run("eval", clip.points_root, given, "--quiet", "--json", tmp_path / "report.json", *options)
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["over"] == "points"
    assert "kt3dinsmoseg, base, over points" in out
    least = 98 if options else 100
    assert all(_only(report)[name] >= least for name in MEASURES)
    assert re.search(r"^0 artifacts to compute", run("plan", clip.points_root, given, *options), re.MULTILINE)


def test_the_pipeline_finds_the_moving_objects_with_the_labelled_number_of_motions(clip, moseg, tmp_path):
    data = ("--dataset", "kt3dinsmoseg", "--root", clip.points_root, "--sequences", CLIP)
    options = ("--motions", "gt", "--variant", "base", "--variant", "fused", "--json", tmp_path / "report.json")
    assert moseg("eval", *data, *options, "--store", tmp_path / "store", "--quiet").code == 0
    report = json.loads((tmp_path / "report.json").read_text())
    assert [row["variant"] for row in report["rows"]] == ["base", "fused"]
    assert report["rows"][0]["mean"]["P"] > 90


def test_a_contact_sheet_shows_right_and_wrong_points(clip, run, tmp_path, write_image, monkeypatch):
    calls = []

    def draw(head, frames, *more):
        calls.append((head, list(frames)))
        return draw_contact_sheet(head, calls[-1][1], *more)

    monkeypatch.setattr(contact_sheets, "draw_contact_sheet", draw)
    missed = clip.scene.moving.max()
    given = _write_predictions(tmp_path / "given", clip.scene.moving % missed, write_image)
    run("contact-sheet", clip.points_root, given, "--quiet", "--frames", "2", "--out", tmp_path / "sheets")
    ((head, frames),) = calls
    assert re.fullmatch(rf"{CLIP}   base   J \d+\.\d   Fu \d+\.\d   over points", head)
    for frame in frames:
        right = np.count_nonzero((frame.labelled.predicted > 0) & (frame.labelled.truth > 0))
        wrong = np.count_nonzero((frame.labelled.predicted > 0) != (frame.labelled.truth > 0))
        assert min(right, wrong) > 20
        assert pytest.approx(100 * right / (right + wrong)) == frame.J
    sheet = np.asarray(Image.open(tmp_path / "sheets" / f"{CLIP}.png"))
    for colour in ((255, 255, 255), (0, 114, 178)):
        assert (sheet[-200:, 180:] == colour).all(axis=-1).any()


def test_a_wrong_number_of_images_is_one_clear_line(clip, moseg, tmp_path, write_image):
    root = tmp_path / "root" / CLIP
    for frame, image in enumerate(clip.scene.images[:-1]):
        write_image(root / "images" / f"{frame:05d}.png", image)
    _write_tracks(root / f"{CLIP}_Tracks.mat", clip.scene)
    ran = moseg("eval", "--dataset", "kt3dinsmoseg", "--root", root.parent, "--sequences", CLIP, "--quiet")
    assert (ran.code, len(ran.err.splitlines())) == (2, 1)
    assert "got 8 frames; expected 7, as many as the clip has images" in ran.err


def test_both_layouts_are_shown(clip, moseg):
    ran = moseg("datasets", "show", "kt3dinsmoseg", "--root", clip.points_root)
    assert (ran.code, ran.err) == (0, "")
    assert "<clip>/masks/*.png" in ran.out
    assert "<clip>/<clip>_Tracks.mat" in ran.out
    assert re.search(rf"^ +here +{CLIP}$", ran.out, re.MULTILINE)
    assert moseg("datasets", "show", "kt3dinsmosegs").code == 2
