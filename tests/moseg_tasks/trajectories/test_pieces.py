"""Laws of the affinity between pieces of trajectories."""

import numpy as np
import pytest

from moseg.schemas.parameters import PieceParams
from moseg.tasks.trajectories.pieces import link_pieces, piece_affinity

NUM_SETS, NUM_HYPOTHESES = 4, 100
PIECES = np.repeat([0, 1, 2], 10)
PARAMS = PieceParams(window=0.1)


def _residual(seed=0):
    """Pieces 0 and 1 are near to the first ten hypotheses, piece 2 to the last ten."""
    rng = np.random.default_rng(seed)
    residual = rng.uniform(1, 2, (NUM_SETS, NUM_HYPOTHESES, len(PIECES)))
    residual[:, :10, PIECES < 2] -= 0.9
    residual[:, -10:, PIECES == 2] -= 0.9
    return residual.astype(np.float16)


def test_pieces_near_the_same_hypotheses_are_alike():
    affinity = piece_affinity(_residual(), PIECES, PARAMS)
    assert affinity[0, 1] > 0.9 and affinity[0, 2] < 0.01
    np.testing.assert_allclose(affinity, affinity.T)
    np.testing.assert_array_equal(np.diag(affinity), 1)


def test_a_few_outliers_of_a_piece_change_nothing():
    residual = _residual()
    residual[:, :, [0, 10]] = np.random.default_rng(1).uniform(0, 50, (NUM_SETS, NUM_HYPOTHESES, 2))
    assert piece_affinity(residual, PIECES, PARAMS)[0, 1] > 0.9


def test_sets_that_do_not_show_both_pieces_take_no_part():
    residual = _residual()
    residual[1:, :, PIECES == 1] = np.nan
    assert piece_affinity(residual, PIECES, PARAMS)[0, 1] > 0.9
    residual[0, :, PIECES == 0] = np.nan
    assert piece_affinity(residual, PIECES, PARAMS)[0, 1] == 0


def test_a_piece_of_one_trajectory_takes_part():
    pieces = np.append(PIECES, 3)
    residual = np.concatenate([_residual(), _residual()[:, :, -1:]], axis=2)
    assert piece_affinity(residual, pieces, PARAMS)[2, 3] > 0.5


def test_names_of_pieces_do_not_matter():
    swapped = piece_affinity(_residual(), 2 - PIECES, PARAMS)
    np.testing.assert_allclose(swapped, piece_affinity(_residual(), PIECES, PARAMS)[::-1, ::-1])


@pytest.mark.parametrize(("count", "groups"), [(1, [0, 0, 0]), (2, [0, 0, 1]), (3, [0, 1, 2])])
def test_the_most_similar_pieces_are_merged_first(count, groups):
    affinity = np.array([[1, 0.8, 0.1], [0.8, 1, 0.2], [0.1, 0.2, 1]])
    merged = link_pieces(affinity)[count - 1]
    assert (merged[:, None] == merged).tolist() == (np.array(groups)[:, None] == groups).tolist()
