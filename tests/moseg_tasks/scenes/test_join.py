"""Objects and motion groups of scenes, numbered over the whole video."""

import numpy as np

from moseg.tasks.scenes import join_motions, join_objects


def _u16(*values):
    return np.array(values, np.uint16)


def test_objects_of_a_later_scene_follow_those_of_the_scenes_before():
    first, second = _u16([0, 1, 2], [0, 2, 0]), _u16([0, 1])
    identity, names = join_objects([first, second], [_u16(0, 1, 2), _u16(0, 1)])
    assert identity.tolist() == [[0, 1, 2], [0, 2, 0], [0, 3, 0]]
    assert names.tolist() == [0, 1, 2, 3] and identity.dtype == names.dtype == np.uint16


def test_names_with_gaps_stay_those_of_the_first_scene_and_are_unique():
    same = _u16([0, 1, 2])
    identity, names = join_objects([same, same, same], [_u16(0, 2, 7)] * 3)
    assert identity.tolist() == [[0, 1, 2], [0, 3, 4], [0, 5, 6]]
    assert names.tolist() == [0, 2, 7, 9, 14, 16, 21]


def test_a_scene_without_objects_takes_no_number():
    empty, one = _u16([0]), _u16([0, 1])
    identity, names = join_objects([empty, one, empty, one], [_u16(0), _u16(0, 1)] * 2)
    assert identity.tolist() == [[0, 0], [0, 1], [0, 0], [0, 2]] and names.tolist() == [0, 1, 2]


def test_what_is_static_in_its_scene_is_static_and_other_groups_are_of_one_scene():
    joined = join_motions([_u16(0, 1, 0, 2), _u16(0), _u16(0, 0, 1, 1)])
    assert joined.tolist() == [0, 1, 0, 2, 0, 3, 3] and joined.dtype == np.uint16
