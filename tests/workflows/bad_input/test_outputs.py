"""Where results may be written, and what of a user's files is never touched."""

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image


def _contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("blank", ["", "  "])
def test_no_folder_is_not_the_folder_one_stands_in(segment, assert_refused, write_folder, blank):
    assert_refused(segment(write_folder(), out=blank), "no output folder named", "--out")
    assert not list(Path.cwd().iterdir())


@pytest.mark.parametrize("below", ["", "deeper", "deeper/still"])
def test_a_file_where_a_folder_should_be(refuse, write_folder, tmp_path, below):
    file = tmp_path / "results"
    file.write_text("precious")
    refuse(write_folder(), f"cannot write in {file}", out=file / below)
    assert file.read_text() == "precious"


@pytest.mark.parametrize("name", ["masks", "overlay.mp4", "motion.json"])
def test_something_of_another_kind_under_a_name_of_ours_is_found_before_the_work(refuse, write_folder, tmp_path, name):
    out = tmp_path / "out"
    out.mkdir()
    if name == "masks":
        (out / name).write_text("precious")
    else:
        (out / name).mkdir()
    refuse(write_folder(), "cannot write", out / name)
    assert [path.name for path in out.iterdir()] == [name]


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
def test_a_folder_that_may_not_be_written(refuse, write_folder, tmp_path):
    out = tmp_path / "out"
    out.mkdir(mode=0o555)
    refuse(write_folder(), "Permission denied", out)


def test_a_folder_that_cannot_be_made(refuse, write_folder):
    refuse(write_folder(), "cannot write in /proc/moseg", out="/proc/moseg")


def test_a_name_that_is_too_long(refuse, write_folder, tmp_path):
    refuse(write_folder(), "File name too long", out=tmp_path / ("n" * 300))


@pytest.mark.parametrize("below", ["", "results"])
def test_results_in_the_folder_of_the_frames_leave_the_frames_alone(segment, write_folder, below):
    folder = write_folder()
    before = _contents(folder)
    for _ in range(2):
        ran = segment(folder, out=folder / below)
        assert (ran.code, ran.err) == (0, "")
        assert len(list((folder / below / "masks").iterdir())) == 5
        assert _contents(folder).items() >= before.items()


def test_other_files_in_the_output_folder_are_left_alone(segment, write_folder, tmp_path):
    out = tmp_path / "out"
    (out / "masks").mkdir(parents=True)
    mine = [out / "notes.txt", out / "masks" / "readme.md", out / "masks" / "first.png", out / "motion.json.bak"]
    for path in mine:
        path.write_bytes(b"precious")
    assert segment(write_folder()).code == 0
    assert [path.read_bytes() for path in mine] == [b"precious"] * 4


def test_ground_truth_is_never_overwritten_by_masks(refuse, segment, write_folder, tmp_path):
    folder = write_folder("clip/frames")
    masks = write_folder("clip/masks", [np.full((48, 64), 7, np.uint8)] * 5)
    before = _contents(tmp_path / "clip")
    refuse(
        folder, "a file not known as moseg's own", masks / "00000.png", "another output folder", out=tmp_path / "clip"
    )
    assert _contents(tmp_path / "clip") == before


def test_a_mask_corrected_by_hand_is_kept_and_the_run_refused(refuse, masks_of, write_folder, tmp_path):
    folder = write_folder()
    masks_of(folder)
    path = tmp_path / "out" / "masks" / "00001.png"
    with Image.open(path) as image:
        image.load()
    image.save(path)
    refuse(folder, "a file not known as moseg's own", path, "another output folder")


@pytest.mark.parametrize("name", ["overlay.mp4", "motion.json"])
def test_files_of_somebody_else_are_kept(refuse, segment, write_folder, tmp_path, name):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).write_bytes(b"precious")
    folder = write_folder()
    refuse(folder, "a file not known as moseg's own", tmp_path / "out" / name)
    if name == "overlay.mp4":
        assert segment(folder, "--overlay", "none").code == 0
        assert (tmp_path / "out" / name).read_bytes() == b"precious"


def test_exports_that_would_replace_a_file_are_refused_before_the_work(refuse, write_folder, tmp_path):
    (tmp_path / "out" / "colmap").mkdir(parents=True)
    folder = write_folder()
    for name, path in (("coco", tmp_path / "out" / "coco.json"), ("colmap", tmp_path / "out/colmap/00003.png.png")):
        path.write_text("precious")
        refuse(folder, "not known as moseg's own", path, options=("--export", name))


def test_a_folder_whose_name_is_no_utf_8(segment, write_folder, tmp_path):
    folder = write_folder().rename(os.fsdecode(os.fsencode(tmp_path) + b"/f\xffr"))
    ran = segment(folder, "--export", "npz")
    assert (ran.code, ran.err) == (0, "")
    assert (tmp_path / "out" / "f\\udcffr.npz").exists()


def test_the_input_is_never_overwritten(refuse, segment, masks_of, write_folder, tmp_path):
    masks_of(write_folder())
    before = _contents(tmp_path / "out")
    for name in ("masks", "overlay.mp4"):
        path = tmp_path / "out" / name
        refuse(path, "the results would replace their input", path, "another --out")
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "out" / "masks")
    refuse(link, "the results would replace their input")
    assert _contents(tmp_path / "out") == before


def test_masks_of_an_earlier_run_are_replaced_even_where_it_was_cut_off(segment, write_folder, tmp_path):
    long, short = write_folder("long"), write_folder("short")
    (short / "00004.png").unlink()
    assert segment(long).code == 0
    # A run that is killed while it writes leaves masks, and motion.json, which comes last, not yet.
    (tmp_path / "out" / "motion.json").unlink()
    assert segment(short).code == 0
    assert len(list((tmp_path / "out" / "masks").iterdir())) == 4


@pytest.mark.parametrize("kind", ["folder", "below a file"])
def test_a_report_that_cannot_be_written_is_said_before_the_work(
    moseg, assert_refused, tmp_path, in_empty_folder, kind
):
    (tmp_path / "file").write_text("precious")
    target = tmp_path if kind == "folder" else tmp_path / "file" / "page.html"
    ran = moseg("eval", "--dataset", "synthetic", "--sequences", "pan", "--report", target, "--quiet")
    assert_refused(ran)
    assert not Path(".moseg").exists()


def test_masks_keep_their_values_beside_the_mark_that_they_are_ours(masks_of, write_folder, tmp_path):
    masks = masks_of(write_folder())
    with Image.open(tmp_path / "out" / "masks" / "00000.png") as image:
        assert image.mode == "P"
        assert image.info["Software"] == "moseg"
    assert set(np.unique(masks)) <= {0, 1, 2}


@pytest.mark.parametrize(
    "name", ["motion.json", "overlay.mp4", "masks/00000.png", "coco.json", "corrections.yaml", "page"]
)
def test_a_page_is_never_one_of_the_results(refuse, write_folder, tmp_path, name):
    page = tmp_path / "out" / name
    refuse(write_folder(), "a page that may replace a result", "--report", page, options=("--report", page))
    assert not page.exists()


def test_a_page_may_lie_beside_the_results(segment, write_folder, tmp_path):
    folder = write_folder()
    for name in ("out/page.html", "out/deeper/Page.HTM", "elsewhere"):
        assert segment(folder, "--report", tmp_path / name).code == 0
        assert "<!doctype html>" in (tmp_path / name).read_text().lower()


def test_exports_of_an_earlier_run_are_named(segment, write_folder, tmp_path):
    folder, out = write_folder(), tmp_path / "out"
    first = segment(folder, "--export", "coco", "--export", "colmap", "--export", "npz", "--for", "nerfstudio")
    assert first.code == 0 and "earlier run" not in first.out
    (out / "ytvis.json").write_text("{}")
    again = segment(folder, "--end", "3", "--export", "coco")
    assert again.code == 0
    (note,) = [line for line in again.out.splitlines() if "earlier run" in line]
    paths = f"{out / 'colmap'}, {out / 'frames.npz'}, {out / 'for-nerfstudio'}"
    assert note == f"note: {paths} are of an earlier run; --export and --for write exports anew"


def test_a_run_that_is_refused_leaves_no_empty_folder(refuse, write_folder, tmp_path, monkeypatch):
    monkeypatch.setenv("MOSEG_STORE_SIZE", "abc")
    folder, there = write_folder(), tmp_path / "there"
    there.mkdir()
    refuse(folder, "MOSEG_STORE_SIZE", out=tmp_path / "new")
    refuse(folder, "MOSEG_STORE_SIZE", out=there)
    assert there.exists() and not (tmp_path / "new").exists()
