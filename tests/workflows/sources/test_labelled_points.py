"""Trajectories of a clip as ground truth at points."""

import numpy as np
import pytest
from scipy.io import savemat

from moseg.schemas.errors import InputError
from moseg.workflows.sources import LabelledPointFile

SIZE, NUM_FRAMES = (48, 64), 3
POINTS = np.random.default_rng(0).uniform(0, 47, (6, NUM_FRAMES, 2))
LABELS = np.array([2, 1, 1, 4, 1, 2])


@pytest.fixture
def write(tmp_path):
    """Return a function that writes trajectories, visible everywhere, and returns their source."""

    def call(points=POINTS, labels=LABELS, name="a", num_frames=NUM_FRAMES, size=SIZE):
        homogeneous = np.concatenate([points, np.ones((*points.shape[:2], 1))], -1).transpose(2, 0, 1)
        data = {"ySparse": homogeneous, "visibleSparse": np.ones(points.shape[:2]), "GtLabel": labels[:, None]}
        savemat(tmp_path / f"{name}_Tracks.mat", {"Data": data})
        return LabelledPointFile(str(tmp_path / f"{name}_Tracks.mat"), num_frames, size)

    return call


def test_label_one_is_static_and_the_others_keep_their_names(write):
    found = write().read()
    assert found.labels.tolist() == [2, 0, 0, 4, 0, 2]
    np.testing.assert_array_equal(found.points, POINTS)
    assert found.visible.all()
    assert (found.points.dtype, found.labels.dtype) == (np.float64, np.uint16)


def test_the_background_is_not_the_largest_group(write):
    assert write(labels=np.array([1, 2, 2, 2, 2, 2])).read().labels.tolist() == [0, 2, 2, 2, 2, 2]


def test_a_point_outside_the_frame_is_not_visible(write):
    points = POINTS.copy()
    points[0, :, 0] = (-0.5, 63.49, 63.5)
    points[1, :, 1] = (-0.51, 47.49, 47.5)
    assert write(points).read().visible[:2].tolist() == [[True, True, False], [False, True, False]]


@pytest.mark.parametrize("num_frames", [NUM_FRAMES - 1, NUM_FRAMES + 1])
def test_another_number_of_frames_is_one_clear_line(write, num_frames):
    with pytest.raises(InputError, match=rf"a_Tracks\.mat; got 3 frames; expected {num_frames}, as many as the clip"):
        write(num_frames=num_frames).read()


def test_points_of_larger_frames_are_refused(write):
    with pytest.raises(InputError, match=r"outside the frame in .*_Tracks\.mat; got .* expected .* 64x48 px"):
        write(POINTS * 10).read()


def test_the_fingerprint_follows_bytes_frames_and_size_and_not_the_name(write):
    same = write().fingerprint()
    assert write(name="b").fingerprint() == same
    others = [write(POINTS + 1), write(labels=LABELS + 1), write(num_frames=4), write(size=(64, 48))]
    assert len({same, *(source.fingerprint() for source in others[2:])}) == 3
    assert write(POINTS + 1).fingerprint() != same != write(labels=LABELS + 1).fingerprint()
