"""Groups of tracks with the rest of the surfaces that they have a good part of."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg.schemas.parameters import TrackObjectParams
from moseg.tasks.track_objects.wholeness import complete_objects

PARAMS = TrackObjectParams()


def _complete(group, surface, **changes):
    arrays = np.array(group, np.int64), np.array(surface, np.uint16)
    return complete_objects(*arrays, PARAMS.model_copy(update=changes))


def test_a_group_takes_the_rest_of_a_surface_of_which_it_has_a_good_part():
    found = _complete([0, -1, -1, -1, -1, 0], [1, 1, 1, 1, 0, 0])
    assert found.group.dtype == np.int64
    assert found.group.tolist() == [0, 0, 0, 0, -1, 0]
    assert found.is_on_surface.tolist() == [True] * 4 + [False] * 2
    assert found.on_surface.tolist() == [4 / 5]


def test_a_smaller_part_takes_nothing_and_does_not_lie_on_the_surface():
    group, surface = [0, -1, -1, -1, -1], [1, 1, 1, 1, 1]
    found = _complete(group, surface)
    assert found.group.tolist() == group
    assert found.on_surface.tolist() == [0]
    assert _complete(group, surface, min_surface=0.2).group.tolist() == [0] * 5
    assert _complete([0] * 5, surface, min_surface=1.01).on_surface.tolist() == [0]


def test_the_largest_part_takes_the_rest_and_the_others_keep_theirs():
    found = _complete([1, 1, 0, -1, -1], [2, 2, 2, 2, 2])
    assert found.group.tolist() == [1, 1, 0, 1, 1]
    assert found.on_surface.tolist() == [0, 1]
    # Of equal parts that of the first group, on any surface.
    found = _complete([1, 0, -1, 0, 1, -1], [1, 1, 1, 3, 3, 3])
    assert found.group.tolist() == [1, 0, 0, 0, 1, 0]
    # A third of a surface is a good part of it, whoever takes the rest.
    assert found.on_surface.tolist() == [1, 1]


def test_a_group_may_take_several_surfaces():
    found = _complete([0, -1, 0, -1, 0], [1, 1, 2, 2, 0])
    assert found.group.tolist() == [0] * 5
    assert found.on_surface.tolist() == [4 / 5]


@pytest.mark.parametrize(
    ("group", "surface"), [([], []), ([-1], [0]), ([-1, -1], [1, 1]), ([0, 1], [0, 0]), ([0], [65535])]
)
def test_nothing_to_take(group, surface):
    found = _complete(group, surface)
    assert found.group.tolist() == group
    assert len(found.on_surface) == max(group, default=-1) + 1
    assert found.on_surface.tolist() == [float(each > 0) for each in surface][: len(found.on_surface)]


@given(st.lists(st.tuples(st.integers(-1, 3), st.integers(0, 4)), max_size=40), st.floats(0.01, 1.2))
def test_each_surface_is_taken_alone_and_no_group_loses_a_track(tracks, share):
    group, surface = np.array(tracks, np.int64).reshape(-1, 2).T
    given_both = group.copy(), surface.copy()
    found = _complete(group, surface, min_surface=share).group
    np.testing.assert_array_equal(found[group >= 0], group[group >= 0])
    for number in range(1, 5):
        alone = _complete(group, np.where(surface == number, number, 0), min_surface=share).group
        np.testing.assert_array_equal(found[surface == number], alone[surface == number])
        gained = {*found[(surface == number) & (group < 0)].tolist()} - {-1}
        assert len(gained) <= 1
    np.testing.assert_array_equal(found[surface == 0], group[surface == 0])
    np.testing.assert_array_equal((group, surface), given_both)
