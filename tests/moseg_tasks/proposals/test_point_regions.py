"""Regions between the points of an object."""

import numpy as np
import pytest

from moseg.tasks.proposals.point_regions import region_between

SHAPE = (80, 120)
SQUARE = np.stack(np.meshgrid(np.arange(40, 81, 10.0), np.arange(20, 61, 10.0)), axis=-1).reshape(-1, 2)
"""Points every 10 px from (40, 20) to (80, 60), xy."""


def test_what_lies_between_points_is_theirs_and_little_around_them():
    region = region_between(SQUARE, SHAPE, 20, 4, 0)
    assert region[20:61, 40:81].all()
    rows, columns = np.nonzero(region)
    distance = np.hypot(*(np.maximum(np.abs(at - 60 + 20 * row) - 20, 0) for row, at in enumerate((columns, rows))))
    assert 3 < distance.max() < 5


def test_a_gap_wider_than_the_disc_is_none_of_theirs():
    two = np.concatenate([SQUARE[SQUARE[:, 0] < 55], SQUARE[SQUARE[:, 0] > 65]])
    gap = (slice(25, 56), slice(57, 64))
    assert region_between(two, SHAPE, 20, 0, 0)[gap].all()
    assert not region_between(two, SHAPE, 6, 0, 0)[gap].any()


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("side", ["first", "last"])
def test_points_near_the_edge_of_the_frame_reach_it(axis, side):
    last = SHAPE[::-1][axis] - 1
    points = SQUARE.copy()
    points[:, axis] += {"first": 8 - points[:, axis].min(), "last": last - 8 - points[:, axis].max()}[side]
    reaching, ending = (region_between(points, SHAPE, 20, 2, edge) for edge in (10, 0))
    border = np.moveaxis(reaching, 1 - axis, 0)[0 if side == "first" else -1]
    other = points[:, 1 - axis]
    assert border[int(other.min()) : int(other.max()) + 1].all()
    assert not np.moveaxis(ending, 1 - axis, 0)[0 if side == "first" else -1].any()


def test_a_margin_as_wide_as_the_disc_is_the_discs():
    points = np.array([[40.0, 40.0], [80.0, 60.0]])
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]]
    near = np.min([np.hypot(columns - x, rows - y) for x, y in points], axis=0)
    for margin in (4, 6):
        region = region_between(points, SHAPE, 4, margin, 0)
        assert region[near <= 3].all() and not region[near > 5].any()


def test_points_outside_the_frame_count_on_its_edge():
    region = region_between(np.array([[-3.0, 30.0], [2.0, 34.0]]), SHAPE, 10, 2, 0)
    assert region[30, 0]
    assert region.shape == SHAPE
