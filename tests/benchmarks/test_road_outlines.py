"""Outlines drawn by hand: where they are, and how masks and labelled points are compared with them."""

import importlib.util
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
import scipy.io

MEASURE = Path(__file__).resolve().parents[2] / "benchmarks" / "road_outlines" / "measure.py"
SHAPE = (370, 1224)
"""Height and width of the smallest frames of KITTI, px."""


@pytest.fixture(scope="module")
def measure():
    spec = importlib.util.spec_from_file_location("road_outlines", MEASURE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_outline_is_a_body_inside_the_frame(measure):
    for clip in measure.OUTLINES:
        truth, _ = measure._outlined(clip, (SHAPE[0] + 100, SHAPE[1] + 100))
        rows, columns = np.nonzero(truth)
        assert rows.max() < SHAPE[0] and columns.max() < SHAPE[1]
        assert truth.sum() > 0.4 * np.ptp(rows) * np.ptp(columns) > 400


def test_a_mask_is_compared_around_the_outline_alone(measure, monkeypatch, tmp_path):
    clip, drawn = next(iter(measure.OUTLINES.items()))
    truth, distance = measure._outlined(clip, SHAPE)
    masks = {
        "true": truth,
        "far": truth | (distance > measure.SURROUNDINGS),
        "wide": distance <= 10,
        "half": truth & (np.arange(SHAPE[1]) < np.median(np.nonzero(truth)[1])),
        "none": truth & False,
    }
    found = {}
    for name, mask in masks.items():
        labels = np.zeros((drawn["frame"] + 1, *SHAPE), np.uint16)
        labels[-1] = mask
        monkeypatch.setattr(
            measure.moseg, "segment_video", lambda *given, labels=labels, **more: SimpleNamespace(labels=labels)
        )
        found[name] = measure._scores(tmp_path, clip, {}, "", 0)
    assert found["true"] == found["far"] == {"J": 100, "P": 100, "R": 100}
    assert found["wide"]["R"] == 100 and found["wide"]["J"] == found["wide"]["P"] < 90
    assert found["half"]["P"] == 100 and found["half"]["J"] == found["half"]["R"] == pytest.approx(50, abs=3)
    assert found["none"] == {"J": 0, "P": 0, "R": 0}


def test_labelled_points_count_by_how_far_they_lie_outside(measure, monkeypatch, tmp_path):
    clip, drawn = next(iter(measure.OUTLINES.items()))
    monkeypatch.setattr(measure, "OUTLINES", {clip: drawn})
    (tmp_path / clip / "images").mkdir(parents=True)
    for frame in range(drawn["frame"] + 1):
        cv2.imwrite(str(tmp_path / clip / "images" / f"{frame:04d}.png"), np.zeros(SHAPE, np.uint8))
    _, distance = measure._outlined(clip, SHAPE)
    # Two points inside, one each at three distances, one of another mover, and one of the background.
    places = [np.argwhere(distance == 0)[0], np.argwhere(distance == 0)[-1]]
    places += [np.argwhere(np.abs(distance - away) < 0.1)[0] for away in (1, 3, 6, 40)] + [np.array([100, 500])]
    points = np.ones((3, len(places), drawn["frame"] + 1))
    points[:2] = np.array(places)[:, ::-1].T[..., None] + 1
    labels = np.array([[2], [2], [2], [2], [2], [2], [1]])
    data = {"ySparse": points, "visibleSparse": np.ones(points.shape[1:]), "GtLabel": labels}
    scipy.io.savemat(tmp_path / f"{clip}_Tracks.mat", {"Data": data})
    assert measure._points_inside(tmp_path) == pytest.approx({"0": 40, "1": 60, "2": 60, "3": 80}, abs=1e-6)
