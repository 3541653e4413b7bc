import numpy as np

from moseg.schemas.parameters import VideoNetworkParams
from moseg.tasks.video_network import IGNORED, MOVING, STATIC, sure_labels

PARAMS = VideoNetworkParams()
SHAPE = (2, 30, 40)
TOGETHER = np.zeros(SHAPE, np.float16)


def scene() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return foreground, objects and proof of a square that moves, all of it together."""
    foreground = np.full(SHAPE, 0.05, np.float16)
    foreground[:, 10:20, 10:20] = 0.95
    objects = foreground > 0.5
    return foreground, objects, np.where(objects, 1.0, 0.0).astype(np.float16)


def test_the_object_is_moving_and_the_rest_static():
    foreground, objects, proof = scene()
    labels = sure_labels(foreground, objects, proof, TOGETHER, PARAMS)
    assert labels.dtype == np.uint8
    np.testing.assert_array_equal(labels, np.where(objects, MOVING, STATIC))


def test_what_is_neither_likely_nor_unlikely_is_ignored():
    foreground, objects, proof = scene()
    foreground[:, 20:25, 10:20] = 0.5
    assert (sure_labels(foreground, objects, proof, TOGETHER, PARAMS)[:, 20:25, 10:20] == IGNORED).all()


def test_a_pixel_without_proof_is_ignored_however_likely_it_is():
    foreground, objects, proof = scene()
    proof[:, 15:20, 10:20] = 0.3
    labels = sure_labels(foreground, objects, proof, TOGETHER, PARAMS)
    assert (labels[:, 15:20, 10:20] == IGNORED).all() and (labels[:, 10:15, 10:20] == MOVING).all()


def test_a_pixel_that_does_not_move_with_the_others_is_ignored():
    foreground, objects, proof = scene()
    misfit = TOGETHER.copy()
    misfit[:, 15:20, 10:20] = np.log1p(2.0**2)
    labels = sure_labels(foreground, objects, proof, misfit, PARAMS)
    assert (labels[:, 15:20, 10:20] == IGNORED).all() and (labels[:, 10:15, 10:20] == MOVING).all()


def test_a_likely_pixel_far_from_every_object_is_ignored():
    foreground, objects, proof = scene()
    foreground[:, 2, 35], proof[:, 2, 35] = 0.95, 1.0
    assert (sure_labels(foreground, objects, proof, TOGETHER, PARAMS)[:, 2, 35] == IGNORED).all()


def test_there_are_no_labels_if_nothing_moves_or_nothing_is_proven_or_nothing_is_static():
    foreground, objects, proof = scene()
    assert sure_labels(np.zeros_like(foreground), objects, proof, TOGETHER, PARAMS) is None
    assert sure_labels(foreground, np.zeros_like(objects), proof, TOGETHER, PARAMS) is None
    assert sure_labels(foreground, objects, proof * np.float16(0.05), TOGETHER, PARAMS) is None
    assert sure_labels(np.full_like(foreground, 0.9), objects, proof, TOGETHER, PARAMS) is None
