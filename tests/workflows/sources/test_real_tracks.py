"""What real trajectories of KT3DMoSeg show of their pixels and of the label that does not move."""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from moseg.workflows.sources import LabelledPointFile
from moseg.workflows.sources.mat_tracks import decode_mat_tracks
from moseg.workflows.sources.trajectory_files import BACKGROUND_LABEL

REPOSITORY = Path(__file__).parents[3]
DATA = Path(os.environ.get("MOSEG_TEST_DATA", REPOSITORY.parent / "shared" / "data")) / "kt3dmoseg"
FILES = sorted(DATA.glob("*_Tracks.mat"))

pytestmark = pytest.mark.skipif(not FILES, reason="no real trajectories: set MOSEG_TEST_DATA to their folder's parent")


@pytest.fixture(scope="module")
def clips():
    return {path.name: decode_mat_tracks(path.read_bytes(), str(path)) for path in FILES}


def test_pixels_are_counted_from_zero_with_centres_at_integers(clips):
    seen = np.concatenate([points[visible] for points, visible, _ in clips.values()])
    # KITTI's frames have up to 1242x375 px; counted from 1 the least would be 0.5.
    assert (seen >= -0.5).all()
    assert (seen.min(axis=0) < 0).all()
    assert (seen < (1241.5, 374.5)).all()


def test_the_background_spreads_over_the_frame_and_nothing_else_does(clips):
    for points, visible, labels in clips.values():
        areas = {label: _hull_area(points[labels == label], visible[labels == label]) for label in np.unique(labels)}
        background = areas.pop(BACKGROUND_LABEL)
        assert background > 0.6 * 1242 * 375
        assert max(areas.values()) < 0.4 * 1242 * 375


def test_all_points_are_inside_frames_of_their_size(clips):
    for path in FILES:
        _, visible, labels = clips[path.name]
        found = LabelledPointFile(str(path), visible.shape[1], (375, 1242)).read()
        np.testing.assert_array_equal(found.visible, visible)
        np.testing.assert_array_equal(found.labels > 0, labels != BACKGROUND_LABEL)


def _hull_area(points, visible):
    return cv2.contourArea(cv2.convexHull(points[visible].astype(np.float32)))
