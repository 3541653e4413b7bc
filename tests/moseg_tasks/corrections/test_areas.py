"""Largest areas of objects, and which objects are too small."""

import numpy as np

from moseg.tasks.corrections.areas import largest_areas, small_objects


def test_the_largest_area_is_that_of_one_frame():
    masks = np.zeros((3, 4, 5), np.uint16)
    masks[0, 0, :2] = 1
    masks[1, :2, :3] = 1
    masks[2, 3, 4] = 3
    np.testing.assert_allclose(largest_areas(masks), [0.95, 0.3, 0.0, 0.05])
    assert largest_areas(np.zeros((2, 4, 5), np.uint16)).tolist() == [1.0]


def test_an_object_is_small_if_it_is_small_in_every_section():
    sections = [
        (np.array([0, 4, 7, 9]), np.array([0.9, 0.02, 0.3])),
        (np.array([0, 7, 4]), np.array([1.0, 0.01, 0.05])),
    ]
    assert small_objects(sections, 0.04) == frozenset()
    assert small_objects(sections, 0.05) == frozenset()
    assert small_objects(sections, 0.06) == {4}
    assert small_objects(sections, 0.4) == {4, 7}
