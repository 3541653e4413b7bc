"""A drive at another frame rate is the same drive: where everything was after a time, it is after as many seconds."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from moseg.tasks.synthetic import SCENES, camera_at

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture
def frame_rates(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import frame_rates

    return frame_rates


@pytest.mark.parametrize("name", ["drive-oncoming-car", "drive-crossing-cyclist"])
def test_a_slowed_drive_is_as_far_after_the_same_time(frame_rates, name):
    scene = SCENES[name]
    slow = frame_rates.slowed(scene, 3)
    assert slow.num_frames == 3 * scene.num_frames
    for time in (0, 5):
        poses = [
            camera_at(each.camera, time * factor, each.height, each.width).pose
            for each, factor in ((scene, 1), (slow, 3))
        ]
        np.testing.assert_allclose(*(pose.rotation for pose in poses), atol=1e-12)
        np.testing.assert_allclose(*(pose.translation for pose in poses), atol=1e-12)
        places = [
            [
                (thing.position.at(time * factor), [part.angles.at(time * factor) for part in thing.parts])
                for thing in things
            ]
            for things, factor in ((scene.things, 1), (slow.things, 3))
        ]
        for (place, angles), (slow_place, slow_angles) in zip(*places, strict=True):
            assert slow_place == pytest.approx(place)
            np.testing.assert_allclose(slow_angles, angles, atol=1e-9)


def test_sequences_are_written_with_what_moves(frame_rates, tmp_path):
    scene = SCENES["drive-oncoming-car"].model_copy(update={"num_frames": 2, "height": 47, "width": 156})
    frame_rates.write_sequence(tmp_path / "drive", scene)
    masks = [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in sorted((tmp_path / "drive" / "masks").iterdir())]
    assert [np.unique(mask).tolist() for mask in masks] == [[0, 2]] * 2
    assert len(list((tmp_path / "drive" / "frames").iterdir())) == 2
