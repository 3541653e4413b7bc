"""A recording of rendered frames is theirs with noise and the losses of a video file, the same each time."""

from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture
def slow_motion(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import slow_motion

    return slow_motion


def test_a_recording_is_noisy_coded_and_the_same_each_time(slow_motion):
    images = np.full((3, 33, 49, 3), 120, np.uint8)
    images[:, 10:20, 10:20] = 200
    recorded, again = (np.stack([*slow_motion.record(images)]) for _ in range(2))
    np.testing.assert_array_equal(recorded, again)
    assert recorded.shape == images.shape and recorded.dtype == np.uint8
    difference = recorded.astype(int) - images
    assert difference[:, :32, :48].any() and abs(difference).mean() < 10
    # H.264 has even sides.
    assert not difference[:, 32:].any() and not difference[:, :, 48:].any()
