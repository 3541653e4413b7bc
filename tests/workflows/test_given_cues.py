"""Flow and point tracks from folders replace the estimated ones."""

import shutil
from itertools import pairwise

import cv2
import numpy as np
import pytest
from PIL import Image

from moseg.schemas.parameters import FlowParams
from moseg.store import open_store
from moseg.tasks.flow import estimate_flow
from moseg.workflows.stages.flow import STAGE as FLOW

SECTIONS = ("--section-length", "4", "--set", "sections.overlap=2")
NUM_FRAMES, HEIGHT, WIDTH = 10, 96, 128
FORWARD, BACKWARD = "forward", "backward"
STEPS = {0: (-1, 0), 1: (3, 0), 2: (-1, 3)}
"""How the backdrop and the two squares move, px/frame."""


OF_FRAMES = FlowParams(search_side=128)
"""Of a search that ends on the grid of the frames, which is that of given flow."""


@pytest.fixture(scope="module")
def frames(squares):
    return squares / "squares" / "frames"


@pytest.fixture(scope="module")
def estimated(frames):
    """Return the flow that the pipeline estimates and keeps, forward and backward, float32 (pair, y, x, 2)."""
    images = [np.asarray(Image.open(path)) for path in sorted(frames.iterdir())]
    pairs = list(pairwise(images))
    step = np.float32(FLOW.arrays["flow"].step)
    flows = {
        FORWARD: np.stack([estimate_flow(image0, image1, OF_FRAMES) for image0, image1 in pairs]),
        BACKWARD: np.stack([estimate_flow(image1, image0, OF_FRAMES) for image0, image1 in pairs]),
    }
    return {direction: np.rint(flow / step) * step for direction, flow in flows.items()}


def _save_npy(path, flow):
    np.save(path.with_suffix(".npy"), flow)


def _save_flo(path, flow):
    cv2.writeOpticalFlow(str(path.with_suffix(".flo")), flow)


def _save_kitti(path, flow, valid=None):
    valid = np.ones(flow.shape[:2]) if valid is None else valid
    stored = np.dstack([np.rint(flow * 64 + 2**15), valid]).astype(np.uint16)
    cv2.imwrite(str(path.with_suffix(".png")), stored[..., ::-1])


def _write_flow(folder, flows, save=_save_npy):
    folder.mkdir(parents=True)
    for number, flow in enumerate(flows):
        save(folder / f"{number:05d}", flow)
    return folder


@pytest.fixture
def flow_folder(tmp_path, estimated):
    """Return a function that writes the estimated flow of given directions and returns the folder."""

    def write(*directions, save=_save_npy):
        for direction in directions:
            _write_flow(tmp_path / "flow" / direction, estimated[direction], save)
        return tmp_path / "flow"

    return write


def _tracks(masks):
    """Return exact tracks of a grid of points of the first frame."""
    y, x = (grid.ravel() for grid in np.mgrid[4:HEIGHT:4, 4:WIDTH:4])
    step = np.array([STEPS[label] for label in masks[0, y, x]])
    points = np.stack([x, y], axis=-1)[:, None] + step[:, None] * np.arange(NUM_FRAMES)[:, None]
    inside = ((points >= 0) & (points < (WIDTH, HEIGHT))).all(axis=-1)
    column, row = np.moveaxis(np.where(inside[..., None], points, 0), -1, 0)
    # A square that passes over a point hides it.
    visible = inside & (masks[np.arange(NUM_FRAMES), row, column] == masks[0, y, x][:, None])
    return points.astype(np.float64), visible


@pytest.fixture(scope="module")
def truth(squares):
    """Return the labels of the two squares, uint8 (frame, y, x)."""
    return np.stack([np.asarray(Image.open(path)) for path in sorted((squares / "squares" / "masks").iterdir())])


@pytest.fixture
def track_file(tmp_path, truth):
    points, visible = _tracks(truth)
    np.savez(tmp_path / "tracks.npz", points=points, visible=visible)
    return tmp_path / "tracks.npz"


@pytest.fixture
def segment(frames, moseg, tmp_path):
    """Return a function that segments the squares and returns the masks and the command's output."""

    def call(*options, store="store", overlap=2):
        files = ("--store", tmp_path / store, "--out", tmp_path / "out", "--quiet")
        sections = ("--section-length", "4", "--set", f"sections.overlap={overlap}")
        ran = moseg("segment", frames, "--keep-cues", *options, *files, *sections)
        assert (ran.code, ran.err) == (0, "")
        return np.stack([np.asarray(Image.open(path)) for path in sorted((tmp_path / "out/masks").iterdir())]), ran.out

    return call


@pytest.fixture
def refused(frames, moseg, tmp_path):
    """Return a function that runs a segmentation with bad input and returns its error message."""

    def call(*options):
        ran = moseg("segment", frames, *options, "--store", tmp_path / "store", "--out", tmp_path / "out", *SECTIONS)
        assert (ran.code, ran.out) == (2, "")
        assert len(ran.err.splitlines()) == 1, ran.err
        return ran.err

    return call


def _stages(folder):
    store = open_store(str(folder), create=False)
    return {ref.partition("/")[0] for ref in store.refs()}


@pytest.mark.parametrize("save", [_save_npy, _save_flo])
def test_flow_from_files_gives_the_result_of_the_same_estimated_flow(segment, flow_folder, tmp_path, save):
    expected, _ = segment("--set", f"flow.search_side={OF_FRAMES.search_side}", store="estimated")
    found, _ = segment("--flow", f"folder:{flow_folder(FORWARD, BACKWARD, save=save)}")
    assert expected.any()
    np.testing.assert_array_equal(found, expected)
    assert "flow" in _stages(tmp_path / "estimated")
    assert "flow" not in _stages(tmp_path / "store")


def test_forward_flow_alone_is_enough_for_given_masks(segment, refused, squares, tmp_path, estimated, truth):
    folder = _write_flow(tmp_path / "flat", estimated[FORWARD])
    masks = ("--proposals", f"folder:{squares / 'squares' / 'masks'}")
    found, _ = segment("--flow", f"folder:{folder}", *masks)
    np.testing.assert_array_equal(found, truth)
    assert "needs flow in both directions" in refused("--flow", f"folder:{folder}")


def test_flow_that_was_read_once_is_not_read_again_and_a_changed_file_is(segment, flow_folder, estimated):
    folder = flow_folder(FORWARD, BACKWARD)
    segment("--flow", f"folder:{folder}")
    assert "(0 artifacts computed" in segment("--flow", f"folder:{folder}")[1]
    np.save(folder / FORWARD / "00003.npy", estimated[FORWARD][3] + 1)
    assert "(0 artifacts computed" not in segment("--flow", f"folder:{folder}")[1]


def test_invalid_pixels_of_kitti_do_not_count_as_at_rest(segment, squares, tmp_path, estimated, truth):
    def save(path, flow):
        # One pixel in seven is valid, as sparse as in laser scans.
        valid = np.arange(HEIGHT * WIDTH).reshape(HEIGHT, WIDTH) % 7 == 0
        _save_kitti(path, flow * valid[..., None], valid)

    folder = _write_flow(tmp_path / "kitti", estimated[FORWARD], save)
    masks = ("--proposals", f"folder:{squares / 'squares' / 'masks'}")
    found, _ = segment("--flow", f"folder:{folder}", *masks, "--variant", "oc-depth")
    np.testing.assert_array_equal(found, truth)


def test_flow_with_gaps_finds_the_objects_of_the_whole_flow(segment, tmp_path, estimated):
    def save(path, flow):
        valid = np.indices(flow.shape[:2]).sum(axis=0) % 2
        _save_kitti(path, flow * valid[..., None], valid)

    for direction in (FORWARD, BACKWARD):
        _write_flow(tmp_path / "whole" / direction, estimated[direction], _save_kitti)
        _write_flow(tmp_path / "gaps" / direction, estimated[direction], save)
    expected, _ = segment("--flow", f"folder:{tmp_path / 'whole'}")
    found, _ = segment("--flow", f"folder:{tmp_path / 'gaps'}")
    both, either = np.count_nonzero((found > 0) & (expected > 0)), np.count_nonzero((found > 0) | (expected > 0))
    assert both > 0.8 * either


def test_reduced_frames_accept_flow_of_their_own_and_of_the_original_size(segment, squares, tmp_path, estimated):
    masks = ("--proposals", f"folder:{squares / 'squares' / 'masks'}", "--set", "max_side=64")
    _write_flow(tmp_path / "whole", estimated[FORWARD])
    halves = [cv2.resize(flow, (64, 48), interpolation=cv2.INTER_AREA) / 2 for flow in estimated[FORWARD]]
    _write_flow(tmp_path / "half", halves)
    whole, _ = segment("--flow", f"folder:{tmp_path / 'whole'}", *masks)
    half, _ = segment("--flow", f"folder:{tmp_path / 'half'}", *masks)
    assert whole.any()
    np.testing.assert_array_equal(whole, half)


# Sections overlap by fewer frames than the fits of fundamental matrices read of the next section (3), or by more.
@pytest.mark.parametrize("overlap", [2, 4])
def test_tracks_from_a_file_find_the_moving_objects(overlap, segment, squares, track_file, truth, tmp_path):
    masks = ("--proposals", f"folder:{squares / 'squares' / 'masks'}", "--variant", "trajs", "--motions", "3")
    found, _ = segment("--tracks", f"folder:{track_file}", *masks, overlap=overlap)
    np.testing.assert_array_equal(found, truth)
    store = open_store(str(tmp_path / "store"), create=False)
    points, visible = np.load(track_file)["points"], np.load(track_file)["visible"]
    (leaf,) = store.refs("given_tracks")
    np.testing.assert_array_equal(store.read(leaf, "points"), np.where(visible[..., None], points, 0))
    np.testing.assert_array_equal(store.read(leaf, "visible"), visible)


def test_a_wrong_file_among_the_flow_is_named(refused, flow_folder, estimated):
    folder = flow_folder(FORWARD, BACKWARD)
    np.save(folder / BACKWARD / "00004.npy", estimated[BACKWARD][4, 1:])
    assert f"{folder / BACKWARD / '00004.npy'}; got 128x95 px" in refused("--flow", f"folder:{folder}")
    (folder / BACKWARD / "00004.npy").unlink()
    assert "got 8; expected 9 files" in refused("--flow", f"folder:{folder}")


def test_tracks_of_another_video_are_named(refused, track_file):
    points, visible = np.load(track_file)["points"], np.load(track_file)["visible"]
    np.savez(track_file, points=points[:, 1:], visible=visible[:, 1:])
    assert f"{track_file}; got 9 frames; expected 10" in refused("--tracks", f"folder:{track_file}")


def test_tracks_of_a_folder_are_those_named_as_the_video_or_the_only_ones(refused, segment, track_file, tmp_path):
    folder = tmp_path / "tracks"
    assert "no such folder in --tracks" in refused("--tracks", f"folder:{folder}")
    folder.mkdir()
    assert "expected frames.npz" in refused("--tracks", f"folder:{folder}")
    (folder / "notes.txt").write_text("none")
    assert "expected a file of .npz" in refused("--tracks", f"folder:{folder / 'notes.txt'}")
    shutil.copy(track_file, folder / "a.npz")
    alone, _ = segment("--tracks", f"folder:{folder}")
    (folder / "b.npz").write_bytes(b"")
    assert "got 2 files; expected frames.npz" in refused("--tracks", f"folder:{folder}")
    shutil.copy(track_file, folder / "frames.npz")
    named, out = segment("--tracks", f"folder:{folder}")
    np.testing.assert_array_equal(named, alone)
    assert "(0 artifacts computed" in out


def test_each_sequence_of_an_evaluation_has_its_own_cues(squares, moseg, tmp_path, estimated, truth):
    points, visible = _tracks(truth)
    for name in ("one", "two"):
        shutil.copytree(squares / "squares", tmp_path / "data" / name)
        _write_flow(tmp_path / "flow" / name, estimated[FORWARD])
        (tmp_path / "tracks").mkdir(exist_ok=True)
        np.savez(tmp_path / "tracks" / f"{name}.npz", points=points, visible=visible)
    options = ("--dataset", "folder", "--root", tmp_path / "data", "--proposals", "groundtruth", "--motions", "gt")
    cues = ("--flow", f"folder:{tmp_path / 'flow'}", "--tracks", f"folder:{tmp_path / 'tracks'}")
    ran = moseg("eval", *options, *cues, *SECTIONS, "--quiet", "--store", tmp_path / "store")
    assert (ran.code, ran.err) == (0, "")
    assert "100.0" in ran.out
    shutil.rmtree(tmp_path / "flow" / "two")
    ran = moseg("eval", *options, *cues, *SECTIONS, "--quiet", "--store", tmp_path / "store")
    assert (ran.code, ran.out) == (2, "")
    assert "wrong number of flow fields" in ran.err
