"""`moseg export`, and the exports of `segment`: their files, their error messages, and equal scores."""

import json
import shutil
from pathlib import Path
from typing import get_args, get_type_hints

import av
import numpy as np
import pytest
from PIL import Image
from pycocotools.coco import COCO

from moseg.workflows.api import segment_video
from moseg.workflows.cli.segment import OverlayOptions
from moseg.workflows.exports import OverlayMode

pytestmark = pytest.mark.usefixtures("in_empty_folder")

OPTIONS = ("--variant", "base", "--quiet")


@pytest.fixture(scope="module")
def squares_out(squares, tmp_path_factory):
    """Return the output folder of the squares, segmented from given masks with all exports, and the store."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("segmented")
    # A name that the data set's sequence has too, with a space and letters beyond ASCII.
    frames = folder / "Größe 1" / "squares"
    shutil.copytree(squares / "squares" / "frames", frames)
    arguments = ["segment", frames, "--proposals", f"folder:{squares / 'squares' / 'masks'}", *OPTIONS]
    for name in ("coco", "npz", "davis", "colmap", "dynaslam"):
        arguments += ["--export", name]
    arguments += ["--overlay", "mask", "--side-by-side", "--store", folder / "store", "--out", folder / "squares"]
    assert run([str(argument) for argument in arguments]) == 0
    return folder / "squares"


@pytest.fixture
def out(squares_out, tmp_path):
    """Return a folder with a copy of the masks and the summary only."""
    shutil.copytree(squares_out / "masks", tmp_path / "out" / "masks")
    shutil.copy(squares_out / "motion.json", tmp_path / "out")
    return tmp_path / "out"


def _masks(folder):
    return np.stack([np.asarray(Image.open(path)) for path in sorted(folder.glob("*.png"))])


def test_segment_leaves_the_exports_asked_for(squares_out):
    names = {path.name for path in squares_out.iterdir()}
    files = {"coco.json", "squares.npz"}
    assert names == {"masks", "overlay.mp4", "motion.json", "davis", "colmap", "dynaslam", *files}
    labels = _masks(squares_out / "masks")
    assert set(np.unique(labels)) == {0, 1, 2}
    with np.load(squares_out / "squares.npz", allow_pickle=False) as archive:
        np.testing.assert_array_equal(archive["labels"], labels)
    assert len(COCO(str(squares_out / "coco.json")).getAnnIds()) == 20
    np.testing.assert_array_equal(_masks(squares_out / "davis" / "squares"), labels)
    np.testing.assert_array_equal(_masks(squares_out / "dynaslam"), labels > 0)
    assert (squares_out / "colmap" / "00009.png.png").exists()


def test_the_summary_names_the_frames_of_a_folder_and_keeps_its_keys(squares_out):
    summary = json.loads((squares_out / "motion.json").read_text())
    assert summary["frames"] == [f"{number:05d}.png" for number in range(10)]
    described = {"name", "num_frames", "width", "height", "fps", "num_motions", "objects", "frames", "choices"}
    assert summary.keys() == described | {"video", "numbers", "look_at"}


def test_the_overlay_has_the_style_asked_for(squares_out):
    with av.open(str(squares_out / "overlay.mp4")) as container:
        first = next(container.decode(video=0)).to_ndarray(format="rgb24")
    assert first.shape == (96, 256, 3)
    assert first[:, :128].mean() > 100
    still = _masks(squares_out / "masks")[0] == 0
    assert first[:, 128:][still].mean() < 5


def test_the_store_is_not_needed_and_nothing_else_is_touched(out, moseg, squares_out, tmp_path):
    before = {path.name for path in out.iterdir()}
    ran = moseg("export", out, "--to", "coco", "--to", "npz", "--out", tmp_path / "there")
    assert (ran.code, ran.err) == (0, "")
    assert ran.out == f"10 frames: {tmp_path / 'there' / 'coco.json'}, {tmp_path / 'there' / 'squares.npz'}\n"
    assert {path.name for path in out.iterdir()} == before
    for name in ("coco.json", "squares.npz"):
        assert (tmp_path / "there" / name).read_bytes() == (squares_out / name).read_bytes()


@pytest.mark.parametrize("name", ["npz", "davis"])
def test_exported_masks_score_like_those_of_segment(squares_out, squares, moseg, tmp_path, name):
    shutil.copytree(squares_out / "masks", tmp_path / "saved" / "squares" / "masks")
    assert moseg("export", squares_out, "--to", name, "--out", tmp_path / "exported").code == 0
    folders = {"saved": tmp_path / "saved", name: tmp_path / "exported" / (name if name == "davis" else "")}
    scores = []
    for folder in folders.values():
        arguments = ("--dataset", "folder", "--root", squares, "--predictions", folder, "--quiet")
        ran = moseg("score", *arguments, "--json", tmp_path / "score.json")
        assert (ran.code, ran.err) == (0, "")
        scores.append(json.loads((tmp_path / "score.json").read_text())["rows"][0]["sequences"])
    assert scores[0] == scores[1]
    assert scores[0]["squares"]["J"] == pytest.approx(100)


def test_names_of_frames_and_sequence_can_be_given(out, moseg, tmp_path):
    (tmp_path / "images").mkdir()
    for number in range(10):
        Image.new("RGB", (128, 96)).save(tmp_path / "images" / f"frame {number}.jpg")
    given = ("--images", tmp_path / "images", "--name", "two", "--dilate", "0")
    assert moseg("export", out, "--to", "colmap", "--to", "npz", *given).code == 0
    assert (out / "colmap" / "frame 9.jpg.png").exists()
    assert (out / "two.npz").exists()
    np.testing.assert_array_equal(_masks(out / "colmap") == 0, _masks(out / "masks") > 0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("export nowhere --to coco", ("no segmentation in nowhere", "motion.json and masks/")),
        ("export OUT", ("no format named in --to", "colmap")),
        ("export OUT --to coca", ("unknown export format 'coca'", "did you mean 'coco'")),
        ("export OUT --to coco --dilate 3", ("nothing to dilate in --dilate", "colmap")),
        ("export OUT --to colmap --dilate -1", ("--dilate",)),
        ("export OUT --to coco --images nowhere", ("does not exist in nowhere",)),
        ("export OUT --to npz --name a/b", ("not a name of a sequence in --name",)),
        ("segment . --variant base", ("no images",)),
        ("segment OUT/masks --export coca", ("unknown export format 'coca'",)),
        ("segment OUT/masks --overlay nothing", ("--overlay",)),
        (
            "segment OUT/masks --overlay cutout --opacity 0.5",
            ("an option without effect in --opacity", "outline or fill"),
        ),
        (
            "segment OUT/masks --overlay fill --outline-width 3",
            ("an option without effect in --outline-width", "contour"),
        ),
        ("segment OUT/masks --overlay none --identities", ("an option without effect in --identities",)),
        ("segment OUT/masks --opacity 2", ("--opacity",)),
    ],
)
def test_bad_use_is_one_line_and_leaves_nothing(out, moseg, arguments, words):
    before = sorted(out.rglob("*"))
    ran = moseg(*(word.replace("OUT", str(out)) for word in arguments.split()))
    assert (ran.code, ran.out) == (2, "")
    (line,) = ran.err.splitlines()
    for word in words:
        assert word in line
    assert sorted(out.rglob("*")) == before


def test_a_missing_mask_and_one_of_another_size_are_named(out, moseg):
    Image.new("P", (10, 10)).save(out / "masks" / "00003.png")
    ran = moseg("export", out, "--to", "coco")
    assert ran.code == 2
    assert "mask of the wrong size" in ran.err
    (out / "masks" / "00003.png").unlink()
    ran = moseg("export", out, "--to", "coco")
    assert ran.code == 2
    assert "missing mask" in ran.err and "00003.png" in ran.err
    assert not (out / "coco.json").exists()


def test_the_overlay_at_full_size_and_none_and_what_a_killed_run_left(squares, squares_out, moseg, tmp_path):
    store = tmp_path / "store"
    video = (squares / "squares" / "frames", "--proposals", f"folder:{squares / 'squares' / 'masks'}", *OPTIONS)
    arguments = ("segment", *video, "--set", "max_side=64", "--store", store, "--out", "there")
    left = [Path("there") / f".{'0' * 32}.part", Path("there") / "masks" / f".{'f' * 32}.part"]
    for path in left:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"of a killed run")
    sizes = []
    for options in ((), ("--overlay-size", "video", "--overlay", "contour")):
        assert moseg(*arguments, *options).code == 0
        with av.open("there/overlay.mp4") as container:
            sizes.append((container.streams.video[0].width, container.streams.video[0].height))
    assert sizes == [(64, 48), (128, 96)]
    assert not any(path.exists() for path in left)
    ran = moseg(*arguments, "--overlay", "none")
    assert (ran.code, "overlay.mp4" in ran.out) == (0, False)
    assert sorted(path.name for path in Path("there").iterdir()) == ["masks", "motion.json"]


def test_the_command_line_offers_every_style_of_overlay():
    offered = get_args(get_args(get_type_hints(OverlayOptions, include_extras=True)["overlay"])[0])
    assert offered == (*(mode.value for mode in OverlayMode), "none")


@pytest.fixture
def frames(squares_out):
    """Return the folder of the frames of the squares."""
    return squares_out.parent / "Größe 1" / "squares"


def test_frames_and_masks_for_a_program_are_one_set(out, frames, moseg):
    ran = moseg("export", out, "--for", "colmap", "--for", "nerfstudio", "--video", frames, "--every", "4")
    assert (ran.code, ran.err) == (0, "")
    assert ran.out == f"3 frames: {out / 'for-colmap'}, {out / 'for-nerfstudio'}\n"
    images = {path.name for path in (out / "for-colmap" / "images").iterdir()}
    assert images == {"00000.png", "00004.png", "00008.png"}
    assert {path.name for path in (out / "for-colmap" / "masks").iterdir()} == {f"{name}.png" for name in images}
    names = [{path.name for path in (out / "for-nerfstudio" / kind).iterdir()} for kind in ("images", "masks")]
    assert names == [{f"frame_{index:05d}.png" for index in (1, 2, 3)}] * 2


def test_a_set_is_written_by_segment_too_and_thinned_by_time(squares, frames, store_of_squares, moseg, tmp_path):
    given = ("--proposals", f"folder:{squares / 'squares' / 'masks'}", "--store", store_of_squares, "--fps", 10)
    sets = ("--for", "colmap", "--for-every", "0.3s", "--export", "matte")
    ran = moseg("segment", frames, *given, *OPTIONS, *sets, "-o", tmp_path / "set")
    assert (ran.code, ran.err) == (0, "")
    images = sorted(path.name for path in (tmp_path / "set" / "for-colmap" / "images").iterdir())
    assert images == ["00000.png", "00003.png", "00006.png", "00009.png"]
    assert len(list((tmp_path / "set" / "masks").iterdir())) == 10
    with av.open(str(tmp_path / "set" / "matte.mp4")) as container:
        assert sum(1 for _ in container.decode(video=0)) == 10


def test_seconds_of_a_set_are_those_of_the_video_if_frames_are_left_out(frames, moseg, tmp_path):
    given = ("--every", "2", "--fps", 10, "--store", tmp_path / "store", *OPTIONS)
    ran = moseg("segment", frames, *given, "--for", "colmap", "--for-every", "0.4s", "-o", tmp_path / "set")
    assert (ran.code, ran.err) == (0, "")
    images = sorted(path.name for path in (tmp_path / "set" / "for-colmap" / "images").iterdir())
    assert images == ["00000.png", "00004.png", "00008.png"]


def test_a_video_of_another_length_is_one_line_before_anything_is_written(squares_out, moseg, tmp_path):
    frames = np.random.default_rng(0).integers(0, 255, (6, 48, 64, 3), np.uint8)
    segment_video(frames, name="array", store=tmp_path / "store", progress=False).save(tmp_path / "out")
    clip = shutil.copy(squares_out / "overlay.mp4", tmp_path / "clip.mp4")
    ran = moseg("export", tmp_path / "out", "--for", "colmap", "--video", clip, "-o", tmp_path / "set")
    assert ran.code == 2 and "masks and frames differ in number" in ran.err and ran.err.count("\n") == 1
    assert not list(tmp_path.glob("set/for-colmap/images/*"))


@pytest.fixture
def store_of_squares(squares_out):
    return squares_out.parent / "store"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("export OUT --for colmap", ("a format that needs the frames in colmap", "--video VIDEO")),
        ("export OUT --to prores", ("a format that needs the frames in prores", "--video VIDEO")),
        ("export OUT --for colmpa --video FRAMES", ("'colmpa'", "did you mean 'colmap'")),
        ("export OUT --for colmap --video OUT/masks", ("another video in --video", "'squares'")),
        ("export OUT --for colmap --video FRAMES --every 4.5", ("neither a frame nor a time in --every",)),
        ("export OUT --to coco --every 4", ("an option without effect in --every", "--for PROGRAM")),
        ("export OUT --for colmap --video gone.mp4", ("file does not exist", "gone.mp4")),
        ("segment FRAMES --for-every 4", ("an option without effect in --for-every",)),
        ("segment FRAMES --for colmpa", ("did you mean 'colmap'",)),
    ],
)
def test_a_set_that_cannot_be_written_is_one_line(out, frames, moseg, arguments, words):
    words_of = [word.replace("OUT", str(out)).replace("FRAMES", str(frames)) for word in arguments.split()]
    before = sorted(out.rglob("*"))
    ran = moseg(*words_of)
    assert (ran.code, ran.out) == (2, "")
    (line,) = ran.err.splitlines()
    assert all(word in line for word in words), line
    assert sorted(out.rglob("*")) == before


def test_a_cut_out_is_made_of_the_video_that_was_segmented(out, frames, moseg):
    ran = moseg("export", out, "--to", "prores", "--video", frames)
    assert (ran.code, ran.err) == (0, "")
    with av.open(str(out / "cutout.mov")) as container:
        shown = [frame.to_ndarray(format="rgba") for frame in container.decode(video=0)]
    masks = _masks(out / "masks")
    np.testing.assert_array_equal(np.stack(shown)[..., 3] > 127, masks > 0)
    first = np.asarray(Image.open(frames / "00000.png").convert("RGB")).astype(int)
    assert np.abs(shown[0][..., :3] - first).mean() < 6
