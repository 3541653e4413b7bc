"""Distance of the pictures of a pair, by the motion of the pixels from frame to frame."""

import numpy as np
import pytest

from moseg.schemas.parameters import SaliencyParams, SlowMotionParams
from moseg.tasks.slow_motion import choose_gap

PARAMS, SALIENCY = SlowMotionParams(), SaliencyParams()
SHAPE = (120, 200)


def _flow(camera=0.0, mover=0.0, side=20):
    """Return the flow of a camera that pans, and of a square that moves by `mover` beside that."""
    flow = np.zeros((*SHAPE, 2), np.float32)
    flow[..., 0] = camera
    flow[50 : 50 + side, 90 : 90 + side, 1] += mover
    return flow


def _gap(*flows, longest=8):
    return choose_gap(flows, longest, PARAMS, SALIENCY).gap


@pytest.mark.parametrize(("speed", "gap"), [(8, 1), (3.6, 1), (3.4, 2), (1.7, 4), (0.5, 8)])
def test_what_moves_is_brought_to_what_usually_moves(speed, gap):
    assert _gap(_flow(mover=speed)) == gap


def test_a_small_thing_counts_and_a_few_pixels_do_not():
    assert _gap(_flow(mover=8, side=8)) == 1
    assert _gap(_flow(mover=8, side=4)) == 8


def test_the_motion_of_the_camera_is_limited_for_itself():
    found = choose_gap([_flow(camera=5, mover=0.2)], 8, PARAMS, SALIENCY)
    assert found.gap == 4
    assert found.motion == pytest.approx(5, abs=0.1) and found.residual < 0.5
    assert _gap(_flow(camera=30)) == 1


def test_one_pair_of_many_may_move_faster_but_only_so_much():
    slow = [_flow(mover=0.5)] * 7
    assert _gap(*slow, _flow(mover=2.9)) == 8
    assert _gap(*slow, _flow(mover=5)) == 4
    assert _gap(*slow[:6], _flow(mover=3.4), _flow(mover=3.4)) == 2
    assert _gap(*slow[:3], _flow(mover=3.4)) == 2
    assert _gap(*slow, _flow(camera=7)) == 3


def test_nothing_at_all_moves():
    found = choose_gap([_flow()], 5, PARAMS, SALIENCY)
    assert found == (5, 0.0, 0.0)


def test_a_short_scene_limits_the_distance():
    assert _gap(_flow(mover=0.5), longest=3) == 3
