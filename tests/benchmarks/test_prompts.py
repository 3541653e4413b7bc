"""Counting of prompt points in true objects, and the benchmark on a rendered scene."""

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

PROMPTS = Path(__file__).resolve().parents[2] / "benchmarks" / "prompts"


@pytest.fixture(scope="module", autouse=True)
def _prompts_on_the_path():
    sys.path.insert(0, str(PROMPTS))
    yield
    sys.path.remove(str(PROMPTS))


def _frame(owners, objects):
    from hits import PromptedFrame

    from moseg.tasks.instances.motion_prompts import MotionPrompts

    owners = np.array(owners).reshape(-1, 2)
    boxes, points = np.zeros((len(owners), 4), np.float32), np.zeros((len(owners), 2, 2), np.float32)
    prompts = MotionPrompts(np.zeros((20, 30), np.uint16), boxes, points, np.arange(len(owners)))
    return PromptedFrame(0, np.zeros((20, 30, 3), np.uint8), prompts, objects, owners)


@pytest.mark.parametrize(
    ("owners", "expected"),
    [
        ([[1, 1], [2, 2]], (2, 2, 2, 2, 0, 0)),
        ([[1, 0], [2, 2]], (2, 2, 1, 2, 1, 0)),
        ([[1, 2]], (2, 2, 0, 1, 1, 0)),
        ([[1, 1], [0, 0]], (2, 1, 1, 2, 0, 1)),
        ([[1, 1], [0, 1]], (2, 1, 0, 2, 1, 0)),
        ([], (2, 0, 0, 0, 0, 0)),
    ],
)
def test_objects_are_clean_if_none_of_their_prompts_has_a_point_outside(owners, expected):
    from hits import count_hits

    assert count_hits([_frame(owners, (1, 2))]) == expected
    assert count_hits([_frame(owners, (1, 2))] * 2) == tuple(2 * count for count in expected)


def test_a_point_belongs_to_the_mask_that_it_lies_in_and_void_is_no_object():
    from hits import owners_in_masks

    truth = np.zeros((20, 30), np.uint8)
    truth[5:10, 10:20], truth[15:, 25:] = 3, 255
    points = np.array([[[10, 5], [9.4, 5]], [[19.4, 9.4], [29, 19]]])
    assert owners_in_masks(points, truth, 255).tolist() == [[3, 0], [3, 0]]
    assert owners_in_masks(np.zeros((0, 2, 2)), truth, None).shape == (0, 2)


def test_a_point_belongs_to_the_nearest_labelled_point():
    from hits import owners_by_nearest

    known, labels = np.array([[0.0, 0], [10, 0], [20, 0]]), np.array([0, 2, 1])
    assert owners_by_nearest(np.array([[[1, 3], [9, 3]], [[14, 0], [16, 0]]]), known, labels).tolist() == [
        [0, 2],
        [2, 1],
    ]


def test_the_benchmark_hits_the_object_of_a_rendered_scene_and_draws_it(tmp_path, monkeypatch, capsys):
    command = importlib.import_module("motion_prompts")
    target = tmp_path / "prompts.json"
    words = ["--sequences", "pan", "--sheets", str(tmp_path / "sheets"), "--json", str(target)]
    monkeypatch.setattr(sys, "argv", ["motion_prompts.py", *words])
    command.main()
    (name,) = (found := json.loads(target.read_text()))["result"]["synthetic"]["sequences"]
    result = found["result"]["synthetic"]
    assert result["objects"] >= result["hit"] >= 1 and 0 <= result["clean_share"] <= result["hit_share"] <= 100
    assert result["identities"] == result["identities_hit"] == 1
    assert name in capsys.readouterr().out
    with Image.open(tmp_path / "sheets" / f"{name}.png") as sheet:
        assert sheet.width > 600
