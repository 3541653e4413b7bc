"""The peers find an object that moves before a moving camera, and the comparison scores them as it scores us."""

import importlib
import json
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

PEERS = Path(__file__).resolve().parents[2] / "benchmarks" / "peers"
NAMES = ("flow_layers", "gaussian_background", "frame_difference", "flow_threshold")
NUM_FRAMES, HEIGHT, WIDTH, SIDE = 24, 160, 240, 48


@pytest.fixture(scope="module", autouse=True)
def _peers_on_the_path():
    sys.path.insert(0, str(PEERS))
    yield
    sys.path.remove(str(PEERS))


@pytest.fixture(scope="module")
def clip():
    """Return frames of a panning camera, in which a square crosses the frame, and its masks."""
    rng = np.random.default_rng(0)

    def texture(height, width):
        noise = cv2.GaussianBlur(rng.normal(size=(height, width, 3)), (0, 0), 2)
        return np.clip(128 + 45 * noise / noise.std(), 0, 255).astype(np.uint8)

    backdrop, square = texture(HEIGHT, WIDTH + 2 * NUM_FRAMES), texture(SIDE, SIDE)
    frames, masks = [], np.zeros((NUM_FRAMES, HEIGHT, WIDTH), bool)
    for t in range(NUM_FRAMES):
        frame = backdrop[:, 2 * t : 2 * t + WIDTH].copy()
        place = np.s_[50 + t : 50 + t + SIDE, 10 + 6 * t : 10 + 6 * t + SIDE]
        frame[place], masks[t][place] = square, True
        frames.append(frame)
    return frames, masks


def _similarity(found, masks):
    found = np.stack(list(found))
    assert found.dtype == bool and found.shape == masks.shape
    return np.count_nonzero(found & masks) / np.count_nonzero(found | masks)


@pytest.mark.parametrize("name", NAMES)
def test_a_peer_finds_a_square_that_moves_before_a_panning_camera(clip, name):
    frames, masks = clip
    assert _similarity(importlib.import_module(name).segment(frames), masks) > 0.6


@pytest.mark.parametrize("name", NAMES)
def test_a_peer_finds_little_where_only_the_camera_moves(clip, name):
    still = [np.roll(clip[0][0], (t, 2 * t), axis=(0, 1))[20:, 30:] for t in range(6)]
    found = np.stack(list(importlib.import_module(name).segment(still)))
    assert found.mean() < 0.05


@pytest.mark.parametrize("name", NAMES)
def test_a_peer_takes_a_clip_without_texture(name):
    frames = [np.full((64, 80, 3), 90, np.uint8)] * 3
    assert not np.any(list(importlib.import_module(name).segment(frames)))


def test_registration_follows_the_camera(clip):
    registration = importlib.import_module("registration").Registration(clip[0])
    (moved,) = cv2.perspectiveTransform(np.array([[[30.0, 40.0]]]), registration.between(0, 10))
    np.testing.assert_allclose(moved, [[10.0, 40.0]], atol=0.5)
    there_and_back = registration.between(4, 9) @ registration.between(9, 4)
    np.testing.assert_allclose(there_and_back / there_and_back[2, 2], np.eye(3), atol=1e-6)


def test_a_canvas_ends_where_the_camera_has_left_it(clip):
    module, registration = (importlib.import_module(name) for name in ("gaussian_background", "registration"))
    wide = [np.tile(frame, (1, 2, 1)) for frame in clip[0][:1]]
    frames = [wide[0][:, 22 * t : 22 * t + WIDTH] for t in range(10)]
    canvas = module.Canvas(frames, registration.Registration(frames), 0)
    assert canvas.end == 6
    assert len(list(module.segment(frames))) == 10


def test_objects_are_connected_over_space_and_time():
    masks = np.zeros((3, 8, 8), bool)
    masks[0, :3, :3] = masks[1, 2:5, 2:5] = masks[:, 6:, 6:] = True
    labels = importlib.import_module("moving_objects").connected_objects(masks)
    assert set(np.unique(labels)) == {0, 1, 2}
    assert labels[0, 0, 0] == labels[1, 4, 4] != labels[0, 7, 7] == labels[2, 7, 7]


def test_the_comparison_prints_a_table_and_writes_its_figures(squares, tmp_path, monkeypatch, capsys):
    compare = importlib.import_module("compare")
    written = tmp_path / "peers.json"
    words = ["compare.py", "--dataset", "folder", "--root", str(squares), "--json", str(written)]
    monkeypatch.setattr(sys, "argv", words)
    compare.main()
    result = json.loads(written.read_text(encoding="utf-8"))
    assert (result["dataset"], result["quality"], result["num_frames"]) == ("folder", "default", 10)
    assert list(result["methods"]) == ["moseg", *compare.PEERS]
    for method, figures in result["methods"].items():
        assert set(figures) == {"J", "Fu", "objects", "seconds_a_frame", "ratio", "sequences"}
        assert figures["objects"] in (("own",) if method == "moseg" else ("one", "connected"))
        assert figures["seconds_a_frame"] > 0
        (each,) = figures["sequences"].values()
        assert each == {name: figures[name] for name in ("J", "Fu", "seconds_a_frame")}
    assert result["methods"]["moseg"]["ratio"] == 1
    printed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in printed[-len(result["methods"]) :]] == list(result["methods"])


def test_an_unknown_peer_is_named(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["compare.py", "--peers", "frame-diference"])
    with pytest.raises(SystemExit):
        importlib.import_module("compare").main()
    assert "no peer frame-diference" in capsys.readouterr().err
