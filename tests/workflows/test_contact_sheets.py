"""`moseg contact-sheet`: one picture per sequence, from the artifacts of an evaluation."""

import re
import shutil

import numpy as np
import pytest
from PIL import Image

from moseg.store import open_store
from moseg.workflows.exports.draw_contact_sheet import TILE_SIDE, SheetFrame, draw_column, draw_contact_sheet
from moseg.workflows.pipelines import contact_sheets
from moseg.workflows.results.shown_frames import spread

pytestmark = pytest.mark.usefixtures("in_empty_folder")

SECTIONS = ("--section-length", "4", "--set", "sections.overlap=2")


@pytest.fixture
def sheets(moseg, tmp_path):
    """Return a function that makes contact sheets of a ``folder`` data set and returns the output and the pictures."""

    def call(root, *options, out=tmp_path / "sheets"):
        data = ("--dataset", "folder", "--root", root, "--store", tmp_path / "store", "--quiet")
        ran = moseg("contact-sheet", *data, *SECTIONS, "--out", out, *options)
        assert (ran.code, ran.err) == (0, "")
        return ran.out, {path.stem: np.asarray(Image.open(path)) for path in sorted(out.iterdir())}

    return call


@pytest.fixture
def drawn(monkeypatch):
    """Return the recorded arguments of every drawing: head line, frames, title of the soft maps, void."""
    calls = []

    def draw(head, frames, *more):
        frames = list(frames)
        calls.append((head, frames, *more))
        return draw_contact_sheet(head, frames, *more)

    monkeypatch.setattr(contact_sheets, "draw_contact_sheet", draw)
    return calls


def _computed(out):
    return int(re.search(r"^(\d+) artifacts computed", out, re.MULTILINE).group(1))


def _read(root, kind, number):
    return np.asarray(Image.open(root / "squares" / kind / f"{number:05d}.png"))


def _shows(sheet, tile):
    height, width = tile.shape[:2]
    found = np.argwhere((sheet[: 1 - height, : 1 - width] == tile[0, 0]).all(axis=-1))
    return any(np.array_equal(sheet[y : y + height, x : x + width], tile) for y, x in found)


@pytest.mark.parametrize(
    ("num_items", "num_chosen", "positions"),
    [(10, 1, (5,)), (10, 2, (2, 7)), (9, 3, (1, 4, 7)), (3, 8, (0, 1, 2)), (3, 3, (0, 1, 2)), (1, 1, (0,))],
)
def test_frames_are_the_middles_of_equal_runs(num_items, num_chosen, positions):
    assert spread(num_items, num_chosen) == positions


def test_after_an_evaluation_nothing_is_computed(evaluated_copy, moseg, tmp_path):
    options = (*evaluated_copy.arguments[1:], "--store", evaluated_copy.store, "--out", tmp_path / "sheets")
    ran = moseg("contact-sheet", *options)
    path, use = ran.out.splitlines()
    assert (ran.code, path) == (0, str(tmp_path / "sheets" / "squares.png"))
    assert use.startswith("0 artifacts computed")
    with Image.open(path) as sheet:
        assert sheet.width > 8 * TILE_SIDE


def test_a_second_sheet_is_the_same_and_computes_nothing(squares, sheets):
    first, pictures = sheets(squares, "--frames", "2")
    again, same = sheets(squares, "--columns", "2")
    assert _computed(first) > 0
    assert _computed(again) == 0
    np.testing.assert_array_equal(same["squares"], pictures["squares"])


def test_a_missing_soft_map_is_computed_again(squares, sheets, tmp_path):
    sheets(squares, "--frames", "3")
    store = open_store(str(tmp_path / "store"), create=False)
    for ref in list(store.refs("saliency")):
        store.remove(ref)
    assert _computed(sheets(squares, "--frames", "3")[0]) == 3


def test_the_figures_are_those_of_the_evaluation(evaluated_copy, moseg, drawn):
    options = (*evaluated_copy.arguments[1:], "--store", evaluated_copy.store)
    assert moseg("contact-sheet", *options, "--frames", "10").code == 0
    score = evaluated_copy.report["rows"][0]["mean"]
    ((head, frames, title, void),) = drawn
    assert head == f"squares   fused   J {score['J']:.1f}   Fu {score['F']:.1f}"
    assert [frame.index for frame in frames] == list(range(10))
    assert np.mean([frame.J for frame in frames]) == pytest.approx(score["J"])
    assert (title, void) == ("saliency", 255)


def test_each_frame_is_drawn_with_its_own_picture_map_and_mask(squares, sheets, drawn, tmp_path):
    _, pictures = sheets(squares, "--frames", "5")
    store = open_store(str(tmp_path / "store"), create=False)
    maps = {store.manifest(ref).recipe.inputs["frame"]: ref for ref in store.refs("saliency")}
    images = {ref: store.read(ref, "image") for ref in maps}
    sections = {store.manifest(ref).recipe.params["section"]: ref for ref in store.refs("segmentation")}
    labels = np.concatenate([store.read(ref, "labels") for _, ref in sorted(sections.items())])
    ((_, frames, _, void),) = drawn
    assert [frame.index for frame in frames] == [1, 3, 5, 7, 9]
    for frame in frames:
        np.testing.assert_array_equal(frame.image, _read(squares, "frames", frame.index))
        np.testing.assert_array_equal(frame.truth, _read(squares, "masks", frame.index))
        np.testing.assert_array_equal(frame.labels, labels[frame.index])
        (ref,) = (ref for ref, image in images.items() if np.array_equal(image, frame.image))
        np.testing.assert_array_equal(frame.soft_map, store.read(maps[ref], "saliency"))
        for tile in draw_column(frame, "saliency", void).values():
            assert _shows(pictures["squares"], tile)


@pytest.mark.parametrize("given", ["right", "nothing"])
def test_proposals_without_saliency_have_no_row_of_it_and_show_their_errors(
    squares, sheets, write_image, tmp_path, given
):
    for number in range(10):
        mask = _read(squares, "masks", number)
        write_image(tmp_path / "given" / f"{number:05d}.png", mask * (given == "right"))
    source = "groundtruth" if given == "right" else f"folder:{tmp_path / 'given'}"
    _, pictures = sheets(squares, "--proposals", source, "--variant", "base", "--frames", "1")
    truth = _read(squares, "masks", 5)
    labels = truth.astype(np.uint16) * (given == "right")
    tiles = draw_column(SheetFrame(5, _read(squares, "frames", 5), labels, truth=truth, J=0.0), "saliency", 255)
    assert list(tiles) == ["frame", "mask", "errors"]
    for tile in tiles.values():
        assert _shows(pictures["squares"], tile)
    _, with_saliency = sheets(squares, "--frames", "1")
    assert with_saliency["squares"].shape[0] - pictures["squares"].shape[0] > tiles["mask"].shape[0]


def test_void_is_no_error(squares, sheets, write_image, drawn, tmp_path):
    root = tmp_path / "data"
    shutil.copytree(squares, root)
    for number in range(10):
        mask = _read(root, "masks", number).copy()
        mask[60:90, 4:40] = 255
        write_image(root / "squares" / "masks" / f"{number:05d}.png", mask)
    _, pictures = sheets(root, "--proposals", "groundtruth", "--variant", "base", "--frames", "2")
    ((_, frames, _, void),) = drawn
    assert [frame.J for frame in frames] == [100, 100]
    tile = draw_column(frames[0], "saliency", void)["errors"]
    assert _shows(pictures["squares"], tile)
    # Shades of grey: neither a false positive nor a false negative.
    assert np.ptp(tile, axis=-1).max() == 0


def test_without_ground_truth_frames_of_the_whole_video_are_shown_and_no_score(squares, sheets, drawn, tmp_path):
    for name in ("one", "two"):
        shutil.copytree(squares / "squares" / "frames", tmp_path / "data" / name / "frames")
    out, pictures = sheets(tmp_path / "data", "--frames", "2")
    assert out.splitlines()[:2] == [str(tmp_path / "sheets" / f"{name}.png") for name in ("one", "two")]
    assert list(pictures) == ["one", "two"]
    assert [head for head, *_ in drawn] == ["one   fused", "two   fused"]
    for _, frames, *_ in drawn:
        assert [(frame.index, frame.J, frame.truth) for frame in frames] == [(2, None, None), (7, None, None)]


def test_only_annotated_frames_are_shown_if_there_are_any(squares, sheets, drawn, tmp_path):
    shutil.copytree(squares, tmp_path / "data")
    for number in {*range(10)} - {4, 6, 9}:
        (tmp_path / "data" / "squares" / "masks" / f"{number:05d}.png").unlink()
    sheets(tmp_path / "data")
    ((_, frames, *_),) = drawn
    assert [frame.index for frame in frames] == [4, 6, 9]
    for frame in frames:
        np.testing.assert_array_equal(frame.truth, _read(squares, "masks", frame.index))


def test_frames_that_are_reduced_for_analysis_are_scored_at_their_own_size(squares, sheets, drawn):
    sheets(squares, "--proposals", "groundtruth", "--variant", "base", "--set", "max_side=64", "--frames", "10")
    ((head, frames, *_),) = drawn
    assert frames[0].image.shape == (48, 64, 3)
    assert frames[0].truth.shape == (96, 128)
    assert f"J {np.mean([frame.J for frame in frames]):.1f} " in head


def test_other_files_of_the_folder_are_left_alone(squares, sheets, tmp_path):
    (tmp_path / "sheets").mkdir()
    Image.new("L", (3, 3)).save(tmp_path / "sheets" / "mine.png")
    _, pictures = sheets(squares, "--frames", "1")
    assert pictures["mine"].shape == (3, 3)
    assert len(list((tmp_path / "sheets").iterdir())) == 2


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ("--frames 0", "--frames"),
        ("--frames some", "--frames"),
        ("--variant fuse", "--variant"),
        ("--variant fused --dataset sintetic", "sintetic"),
        ("--sequences panning", "panning"),
        ("--flow farneback", "flow.method"),
        ("--set saliency.flor=1", "saliency.floor"),
        ("--dataset folder --root nowhere", "nowhere"),
        ("--out taken", "taken"),
        ("--json scores.json", "--json"),
    ],
)
def test_bad_use_is_one_line_and_exit_code_two(moseg, tmp_path, options, word):
    (tmp_path / "cwd" / "taken").write_text("a file")
    ran = moseg("contact-sheet", *options.split())
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert line.startswith("moseg: ")
    assert word in line
    assert not (tmp_path / "cwd" / ".moseg").exists()


def test_the_true_number_of_motions_needs_ground_truth(squares, moseg, tmp_path):
    shutil.copytree(squares / "squares" / "frames", tmp_path / "data" / "one" / "frames")
    ran = moseg("contact-sheet", "--dataset", "folder", "--root", tmp_path / "data", "--motions", "gt", "--quiet")
    assert ran.code == 2
    assert "--motions gt without ground truth" in ran.err
