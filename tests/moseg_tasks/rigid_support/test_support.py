"""Support of objects for being part of a rigid scene, and of the same objects over sections."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg.schemas.parameters import RigidityParams, RigidSupportParams, SceneParallaxParams
from moseg.tasks.rigid_support import ObjectEvidence, combine_sections, measure_objects, support_of_evidence

PARAMS = RigidSupportParams(step=1)
NEAR, WALL = 25.0, 40.0
MIN_GAIN = 0.2
ATTACHED = {"num_contour": 30.0, "attached": 1.0}
FREE = {"num_contour": 30.0, "attached": 0.1}


def support_of(passage, sensitivity=1.0, min_gain=0.0):
    """Return the support of the object of a passage."""
    labels, *tracks = passage[:6]
    evidence = measure_objects(labels, 2, *tracks, PARAMS, SceneParallaxParams(), RigidityParams())
    background, support = support_of_evidence(evidence, PARAMS, sensitivity, min_gain)
    assert background == 1
    return support


def judge(
    num_observations=500,
    test=0.0,
    num_contour=30.0,
    attached=1.0,
    num_inside=30.0,
    accompanied=1.0,
    sensitivity=1.0,
    num_pairs=20,
    gain=0.3,
    **changes,
):
    """Return the support of an object of this evidence, beside a background of the same."""
    values = (num_observations, test, num_contour, attached, num_inside, accompanied)
    evidence = ObjectEvidence(*(np.array([value, value]) for value in values), num_pairs=num_pairs, gain=gain)
    support = support_of_evidence(evidence, PARAMS.model_copy(update=changes), sensitivity, MIN_GAIN)
    assert support.dtype == np.float64 and support[0] == 1
    return support[1]


def test_an_object_that_was_compared_with_nothing_stays_open(passage):
    assert judge(num_observations=0, num_contour=0) == 1
    assert np.isnan(judge(num_observations=0, num_contour=0, num_pairs=0))
    unknown = passage(WALL)._replace(pairs=np.zeros((0, 2), np.int32), cameras=[], strict_test=np.zeros((0, 1)))
    assert np.isnan(support_of(unknown))


def test_an_object_on_the_wall_is_static(passage):
    assert support_of(passage(WALL)) == 1


def test_an_object_that_moves_parallel_to_the_camera_stays_open(passage):
    # It moves against the camera: all of its points stay on their epipolar lines, at a depth of their own.
    assert np.isnan(support_of(passage(NEAR)))


@pytest.mark.parametrize("depth", [WALL, NEAR])
def test_an_object_that_no_rigid_scene_explains_moves(passage, depth):
    assert support_of(passage(depth, test=1.5)) == 0


def test_an_object_of_few_tracks_is_static(passage):
    assert support_of(passage(NEAR, test=1.5, spacing=45.0)) == 1
    assert judge(PARAMS.min_observations - 1, test=3.0, **FREE) == 1
    assert judge(PARAMS.min_observations, test=3.0, **FREE) == 0


def test_observations_in_pairs_that_are_skipped_count_as_much_as_those_that_are_read():
    few = PARAMS.min_observations // 3
    assert judge(few, test=3.0, **FREE) == 1
    assert judge(few, test=3.0, step=3, **FREE) == 0


def test_the_largest_test_of_a_static_object_is_a_parameter():
    assert judge(test=0.6) == 1
    assert judge(test=0.61) == 0
    assert judge(test=0.61, max_test=0.7) == 1


def test_it_is_asked_whether_an_object_stands_free_where_its_contour_has_tracks():
    assert np.isnan(judge(**FREE))
    assert judge(num_contour=7.9, attached=0.1) == 1
    assert judge(num_contour=30.0, attached=0.75) == 1
    assert judge(num_contour=7.9, attached=0.1, min_contour=7) != 1


def test_an_object_without_tracks_around_it_stands_free_where_nothing_is_at_its_depth():
    nothing_around = {"num_contour": 0.0, "attached": 1.0}
    assert np.isnan(judge(accompanied=0.74, **nothing_around))
    assert judge(accompanied=0.75, **nothing_around) == 1
    assert judge(test=0.61, accompanied=0.0, **nothing_around) == 0
    assert judge(PARAMS.min_observations - 1, accompanied=0.0, **nothing_around) == 1


def test_an_object_with_a_few_tracks_around_it_stands_free_where_neither_they_nor_others_are_at_its_depth():
    assert np.isnan(judge(num_contour=7.9, attached=0.74, accompanied=0.74))
    assert judge(num_contour=7.9, attached=0.75, accompanied=0.0) == 1
    assert judge(num_contour=7.9, attached=0.0, accompanied=0.75) == 1
    assert judge(num_contour=8.0, accompanied=0.0) == 1
    assert np.isnan(judge(num_contour=8.0, attached=0.0, accompanied=1.0))


def test_an_object_of_few_tracks_does_not_stand_free():
    """The depth of a track or two says little, and observations of many pairs are those of few tracks."""
    alone = {"num_contour": 0.0, "accompanied": 0.0}
    assert judge(num_inside=7.9, **alone) == 1
    assert np.isnan(judge(num_inside=8.0, **alone))
    assert judge(num_inside=50.0, min_contour=100.0, **alone) == 1


def test_what_does_not_clearly_move_stays_open_where_only_the_objects_show_depth():
    # One motion before a plane: a rigid scene explains both, as a near thing before a far wall.
    assert judge(gain=0.2) == 1
    assert np.isnan(judge(gain=0.19))
    assert np.isnan(judge(PARAMS.min_observations - 1, gain=0.19))
    assert judge(test=0.61, gain=0.19) == 0


def test_a_wall_behind_an_object_shows_no_depth(passage):
    assert support_of(passage(WALL), min_gain=0.05) != support_of(passage(WALL), min_gain=0.0) == 1


def test_sensitivity_divides_the_evidence_that_a_moving_object_needs():
    assert judge(test=0.4, **ATTACHED) == 1
    assert judge(test=0.4, sensitivity=2.0, **ATTACHED) == 0
    assert judge(6, test=3.0, **ATTACHED) == 1
    assert judge(6, test=3.0, sensitivity=2.0, **ATTACHED) == 0


def test_what_moves_in_one_section_moves_and_what_is_static_in_one_is_not_open():
    first = np.array([1.0, 1.0, np.nan, np.nan, 0.0])
    second = np.array([1.0, 0.0, 1.0, np.nan, np.nan])
    np.testing.assert_array_equal(combine_sections([first, second]), [1, 0, 1, np.nan, 0])
    np.testing.assert_array_equal(combine_sections([first]), first)


@given(st.lists(st.lists(st.sampled_from([0.0, 1.0, np.nan]), min_size=3, max_size=3), min_size=1, max_size=5))
def test_the_order_and_the_repetition_of_sections_do_not_matter(sections):
    supports = [np.array(section) for section in sections]
    combined = combine_sections(supports)
    np.testing.assert_array_equal(combined, combine_sections(supports[::-1]))
    np.testing.assert_array_equal(combined, combine_sections([combined, *supports]))
    np.testing.assert_array_equal(np.isnan(combined), np.isnan(supports).all(axis=0))
