"""Ground truth that does not fit its frames, holds no objects, or is of an unusual kind."""

import json
import shutil

import numpy as np
import pytest
from PIL import Image


@pytest.fixture
def clip(write_folder, tmp_path):
    """A sequence of frames with masks of one object that `--dataset folder` reads; returns its folder."""
    write_folder("data/clip/frames")
    masks = []
    for number in range(5):
        mask = np.zeros((48, 64), np.uint8)
        mask[12:28, 8 + 2 * number : 24 + 2 * number] = 1
        masks.append(mask)
    write_folder("data/clip/masks", masks)
    return tmp_path / "data" / "clip"


@pytest.fixture
def evaluate(moseg, store, clip, tmp_path, in_empty_folder):
    """Evaluates the clip; returns how it ended."""

    def call(*options):
        files = ("--store", store, "--json", tmp_path / "scores.json")
        data = ("--dataset", "folder", "--root", clip.parent)
        return moseg("eval", *data, *files, "--quality", "fast", "--quiet", *options)

    return call


def _write(path, array):
    Image.fromarray(array).save(path)


def _score(tmp_path):
    return json.loads((tmp_path / "scores.json").read_text())


def test_ground_truth_of_another_size_is_named(evaluate, assert_refused, clip, tmp_path):
    _write(clip / "masks" / "00003.png", np.ones((24, 32), np.uint8))
    assert_refused(evaluate(), clip / "masks" / "00003.png", "got 32x24 px", "expected 64x48 px")
    assert not (tmp_path / "scores.json").exists()


@pytest.mark.parametrize("name", ["00005.png", "0.png", "mask.png"])
def test_ground_truth_of_a_frame_that_is_not_there_is_named(evaluate, assert_refused, clip, name):
    _write(clip / "masks" / name, np.ones((48, 64), np.uint8))
    assert_refused(evaluate(), "mask without a frame", clip / "masks" / name)


def test_frames_without_ground_truth_are_not_scored(evaluate, clip, tmp_path):
    for number in (1, 3):
        (clip / "masks" / f"0000{number}.png").unlink()
    assert evaluate().code == 0
    assert (tmp_path / "scores.json").exists()


def test_an_empty_folder_of_masks_is_named(evaluate, assert_refused, clip):
    shutil.rmtree(clip / "masks")
    (clip / "masks").mkdir()
    assert_refused(evaluate(), f"no masks in {clip / 'masks'}", "PNG files named as their frames")


@pytest.mark.parametrize("label", [0, 254])
def test_ground_truth_without_an_object_ends_in_a_score_or_one_line(evaluate, clip, label):
    for path in (clip / "masks").iterdir():
        mask = np.full((48, 64), 255 if label else 0, np.uint8)
        mask[0, 0] = 1 if label else 0
        _write(path, mask)
    ran = evaluate()
    assert ran.code in (0, 2)
    assert "Traceback" not in ran.err
    assert ran.err.count("\n") == (0 if ran.code == 0 else 1)


def test_ground_truth_drawn_in_colours_is_refused_where_objects_are_told_apart(evaluate, assert_refused, clip):
    path = clip / "masks" / "00002.png"
    ids = np.asarray(Image.open(path))
    _write(path, np.stack([ids * 128, ids * 0, ids * 0], axis=-1))
    assert_refused(evaluate(), "mask of colours", path, "object ids (a palette or grey PNG)")


def test_ground_truth_saved_as_grey_rgb_is_read_as_ids(evaluate, clip):
    for path in (clip / "masks").iterdir():
        _write(path, np.repeat(np.asarray(Image.open(path))[..., None], 3, axis=2))
    assert evaluate().code == 0


def test_damaged_ground_truth_is_named(evaluate, assert_refused, clip):
    path = clip / "masks" / "00001.png"
    path.write_bytes(path.read_bytes()[:60])
    assert_refused(evaluate(), "mask cannot be decoded", path)
    path.write_bytes(b"")
    assert_refused(evaluate(), "mask cannot be decoded", path)


CUES = {
    "depth of another size": ("depth", lambda n: np.ones((24, 33)), "depth map of the wrong size"),
    "depth of integers": ("depth", lambda n: np.ones((48, 64), np.int32), "not a depth map"),
    "depth with NaN": ("depth", lambda n: np.full((48, 64), np.nan), "depth map is not finite"),
    "too few depth maps": ("depth", lambda n: np.ones((48, 64)) if n else None, "wrong number of depth maps"),
    "flow of another size": ("flow", lambda n: np.ones((24, 33, 2)) if n else None, "flow of the wrong size"),
    "flow of one channel": ("flow", lambda n: np.ones((48, 64, 1)) if n else None, "not a flow"),
    "flow with NaN": ("flow", lambda n: np.full((48, 64, 2), np.nan) if n else None, "flow"),
    "too many flow fields": ("flow", lambda n: np.ones((48, 64, 2)), "wrong number of flow fields"),
}


@pytest.mark.parametrize("kind", CUES)
def test_a_given_cue_that_does_not_fit_is_one_line(refuse, write_folder, tmp_path, kind):
    cue, make, words = CUES[kind]
    folder = tmp_path / cue
    folder.mkdir()
    for number in range(5):
        array = make(number)
        if array is not None:
            np.save(folder / f"{number}.npy", array)
    masks = write_folder("masks", [np.ones((48, 64), np.uint8)] * 5)
    given = (f"--{cue}", f"folder:{folder}", "--proposals", f"folder:{masks}")
    refuse(write_folder(), words, folder, options=given)


TRACKS = {
    "another number of frames": (np.ones((9, 4, 2)), np.ones((9, 4), bool), "got 4 frames"),
    "integers": (np.ones((9, 5, 2), int), np.ones((9, 5), bool), "not tracks"),
    "no pairs": (np.ones((9, 5, 3)), np.ones((9, 5), bool), "not tracks"),
    "NaN": (np.full((9, 5, 2), np.nan), np.ones((9, 5), bool), "not finite"),
    "another size": (np.full((9, 5, 2), 900.0), np.ones((9, 5), bool), "most points outside the frame"),
}


@pytest.mark.parametrize("kind", TRACKS)
def test_given_tracks_that_do_not_fit_are_one_line(refuse, write_folder, tmp_path, kind):
    points, visible, words = TRACKS[kind]
    path = tmp_path / "tracks.npz"
    np.savez(path, points=points, visible=visible)
    refuse(write_folder(), words, path, options=("--tracks", f"folder:{path}"))


@pytest.mark.parametrize("size", [(24, 32), (48, 65)])
def test_given_masks_of_another_size_are_named(refuse, write_folder, size):
    masks = write_folder("masks", [np.ones(size, np.uint8)] * 5)
    options = ("--proposals", f"folder:{masks}")
    refuse(write_folder(), "mask of the wrong size", masks / "00000.png", "expected 64x48 px", options=options)
