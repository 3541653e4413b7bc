"""Share of the motion between frames that were compared which lies between frames beside each other."""

import numpy as np

from moseg.tasks.saliency import share_out

BOTH = (True, True)


def _flows(to_previous, to_next):
    return np.stack([np.full((4, 6, 2), value, np.float16) for value in (to_previous, to_next)])


def test_the_motion_to_a_distant_frame_is_shared_out():
    shared = share_out(_flows(-4, 8), (0.25, 0.5), BOTH)
    assert shared.dtype == np.float16
    np.testing.assert_array_equal(shared, _flows(-1, 4))


def test_frames_beside_each_other_keep_their_motion():
    np.testing.assert_array_equal(share_out(_flows(0, 3), (1, 1), (False, True)), _flows(0, 3))


def test_to_a_frame_that_shows_the_same_nothing_moves():
    np.testing.assert_array_equal(share_out(_flows(-2, 3), (0, 1), BOTH), _flows(0, 3))


def test_at_an_end_what_moves_goes_on():
    np.testing.assert_array_equal(share_out(_flows(0, 4), (0.25, 0.25), (False, True)), _flows(-1, 1))
    np.testing.assert_array_equal(share_out(_flows(4, 0), (0.25, 0.25), (True, False)), _flows(1, -1))


def test_what_is_given_stays_as_it_is():
    flows = _flows(-4, 8)
    share_out(flows, (0.5, 0.5), BOTH)
    np.testing.assert_array_equal(flows, _flows(-4, 8))


def test_what_rests_on_one_side_rests():
    np.testing.assert_array_equal(share_out(_flows(0, 4), (0.25, 0.25), BOTH), _flows(0, 1))
