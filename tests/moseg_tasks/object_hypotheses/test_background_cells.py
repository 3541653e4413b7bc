"""What the background's cells say of the scale of a kernel."""

import numpy as np
import pytest

from moseg.schemas.parameters import ObjectHypothesisParams
from moseg.tasks.object_hypotheses import background_cells, scale_by_background, split_background
from moseg.tasks.object_hypotheses.background_cells import geometric_mean

PARAMS = ObjectHypothesisParams()
NAN = np.nan


def kernel(objects, cells, between):
    """Nodes: the whole background (absent), objects, cells; affinities of objects, of cells, and across."""
    num_objects, num_cells = len(objects), len(cells)
    full = np.full((1 + num_objects + num_cells,) * 2, NAN)
    full[1 : 1 + num_objects, 1 : 1 + num_objects] = objects
    full[1 + num_objects :, 1 + num_objects :] = cells
    full[1 + num_objects :, 1 : 1 + num_objects] = between
    full[1 : 1 + num_objects, 1 + num_objects :] = np.transpose(between)
    return full


CELLS = [[1, 0.4, 0.2], [0.4, 1, 0.3], [0.2, 0.3, 1]]  # nearest: 0.4, 0.4, 0.3


def test_affinities_are_in_units_of_the_cells_by_hand():
    objects = [[1, 0.1], [0.1, 1]]
    found = scale_by_background(kernel(objects, CELLS, [[0.1, 0.0], [0.2, 0.04], [0.6, 0.02]]), 3, PARAMS)
    np.testing.assert_allclose(found, [[1, 1, 0.1], [1, 1, 0.25], [0.1, 0.25, 1]])


@pytest.mark.parametrize("factor", [0.1, 0.5, 1.0])
def test_a_factor_off_the_diagonal_has_no_effect(factor):
    full = kernel([[1, 0.1], [0.1, 1]], CELLS, [[0.1, 0.0], [0.2, 0.04], [0.3, 0.02]])
    fainter = np.where(np.eye(len(full), dtype=bool), full, factor * full)
    np.testing.assert_allclose(scale_by_background(fainter, 3, PARAMS), scale_by_background(full, 3, PARAMS))


def test_cells_never_visible_are_ignored():
    cells, between = np.full((4, 4), NAN), np.full((4, 1), NAN)
    cells[:3, :3], between[:3] = CELLS, [[0.1], [0.2], [0.0]]
    found = scale_by_background(kernel([[1]], cells, between), 2, PARAMS)
    np.testing.assert_allclose(found, [[1, 0.5], [0.5, 1]])


@pytest.mark.parametrize("cells", [[[1, NAN], [NAN, NAN]], [[1, 0], [0, 1]], [[1, NAN], [NAN, 1]]])
def test_without_two_similar_cells_all_affinities_are_unknown(cells):
    found = scale_by_background(kernel([[1]], cells, [[0.2], [0.3]]), 2, PARAMS)
    np.testing.assert_array_equal(found, [[1, NAN], [NAN, 1]])


def test_a_background_that_is_never_seen_is_unknown():
    found = scale_by_background(kernel([[1]], np.full((2, 2), NAN), [[NAN], [NAN]]), 2, PARAMS)
    np.testing.assert_array_equal(found, [[NAN, NAN], [NAN, 1]])


def test_an_object_that_is_never_seen_is_unknown():
    objects, between = [[NAN, NAN], [NAN, 1]], [[NAN, 0.4], [NAN, 0.4], [NAN, 0.4]]
    found = scale_by_background(kernel(objects, CELLS, between), 3, PARAMS)
    assert np.isnan(found[1]).all()
    np.testing.assert_allclose(found[np.ix_([0, 2], [0, 2])], 1)


def test_if_one_affinity_is_unknown_the_other_is_used():
    found = geometric_mean(np.array([0.25, NAN, 0.5, NAN]), np.array([1.0, 0.3, NAN, NAN]))
    np.testing.assert_allclose(found, [0.5, 0.3, 0.5, NAN])


@pytest.mark.parametrize("shape", [(48, 64), (7, 5), (3, 4)])
def test_cells_cut_the_frame_into_a_grid(shape):
    cells = background_cells(shape, PARAMS)
    assert sorted(set(cells.ravel())) == list(range(12))
    assert (np.diff(cells, axis=1) >= 0).all()
    assert (np.diff(cells, axis=0) >= 0).all()
    sizes = np.bincount(cells.ravel())
    assert sizes.max() <= (shape[0] // 3 + 1) * (shape[1] // 4 + 1)


def test_objects_keep_their_names_and_the_background_takes_its_cells():
    owner, cell = np.array([[0, 1], [2, 0]], np.uint16), np.array([[0, 1], [2, 3]])
    np.testing.assert_array_equal(split_background(owner, cell, 3), [[3, 1], [2, 6]])
