"""Judgement of an object's motion in a frame: its own against the background's, beyond noise."""

import numpy as np
import pytest

from moseg.schemas.parameters import MovesNowParams
from moseg.tasks.saliency import moves_now

PARAMS = MovesNowParams()
SHAPE = (40, 60)
LABELS = np.zeros(SHAPE, np.uint16)
LABELS[8:18, 10:22], LABELS[24:34, 30:44] = 1, 2


def judge(motion, background=0.0, noise=0.0, camera=(0.0, 0.0)):
    """Return what two objects do that move by `motion`, px/frame each, in noise of the background's residual."""
    residual = np.random.default_rng(0).normal(0, max(noise, 1e-6), (*SHAPE, 2)).astype(np.float32)
    for label, speed in enumerate(motion, start=1):
        residual[label == LABELS] += np.float32([speed, 0])
    residual[LABELS == 0] += np.float32([background, 0])
    return moves_now(LABELS, (None, residual + np.float32(camera)), (None, residual), 4, PARAMS).tolist()


def test_one_object_moves_while_another_rests():
    assert judge((1.2, 0.05)) == [-1, 1, 0, -1]


@pytest.mark.parametrize("surroundings", [{"background": 0.5, "noise": 0.3}, {"camera": (30.0, 0.0)}])
def test_motion_below_the_noise_and_the_camera_s_error_is_rest(surroundings):
    assert judge((1.0, 0.0), **surroundings)[1] == 0


def test_one_limb_suffices():
    labels = LABELS.copy()
    labels[labels == 2] = 1
    residual = np.where((LABELS == 2)[..., None], np.float32([2, 0]), np.float32([0, 0]))
    assert moves_now(labels, (residual, None), (residual, None), 2, PARAMS).tolist() == [-1, 1]


def test_without_flow_it_is_not_known():
    assert moves_now(LABELS, (None, None), (None, None), 3, PARAMS).tolist() == [-1, -1, -1]


def test_motion_to_one_neighbour_alone_is_an_occlusion():
    still = np.zeros((*SHAPE, 2), np.float32)
    jump = np.where((LABELS == 1)[..., None], np.float32([5, 0]), np.float32(0))
    for flows in ((still, jump), (jump, still)):
        assert moves_now(LABELS, flows, flows, 3, PARAMS).tolist() == [-1, 0, 0]


def test_the_error_is_a_share_of_the_background_s_motion_not_of_the_object_s():
    residual = np.where((LABELS == 1)[..., None], np.float32([-4, 0]), np.float32(0))
    params = PARAMS.model_copy(update={"floor_motion": 0.5})
    assert moves_now(LABELS, (residual + np.float32([10, 0]),), (residual,), 3, params)[1] == 0
