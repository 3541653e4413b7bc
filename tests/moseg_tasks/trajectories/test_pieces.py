"""Laws of the affinity between pieces of trajectories."""

import numpy as np
import pytest

from moseg.schemas.parameters import PieceParams
from moseg.tasks.trajectories.hypothesis_residuals import NOT_SEEN, distance_codes
from moseg.tasks.trajectories.pieces import _lower_medians, link_pieces, piece_affinity

NUM_SETS, NUM_HYPOTHESES = 4, 100
PIECES = np.repeat([0, 1, 2], 10)
PARAMS = PieceParams(window=0.1)


class Residuals:
    """The distancess of given distances (S, H, N), NaN where not seen."""

    def __init__(self, distances):
        self.is_seen = np.isfinite(distances[:, 0])
        self.num_hypotheses = distances.shape[1]
        codes = distance_codes(distances.astype(np.float32) ** 2)
        codes[np.isnan(distances)] = NOT_SEEN
        self._codes = np.swapaxes(codes, 1, 2)

    def of_tracks(self, tracks):
        return self._codes[:, tracks]


def _distances(seed=0):
    """Pieces 0 and 1 are near to the first ten hypotheses, piece 2 to the last ten."""
    rng = np.random.default_rng(seed)
    distances = rng.uniform(1, 2, (NUM_SETS, NUM_HYPOTHESES, len(PIECES)))
    distances[:, :10, PIECES < 2] -= 0.9
    distances[:, -10:, PIECES == 2] -= 0.9
    return distances


def _affinity(distances, pieces=PIECES, params=PARAMS):
    return piece_affinity(Residuals(distances), pieces, params)


def test_pieces_near_the_same_hypotheses_are_alike():
    affinity = _affinity(_distances())
    assert affinity[0, 1] > 0.9 and affinity[0, 2] < 0.01
    np.testing.assert_allclose(affinity, affinity.T)
    np.testing.assert_array_equal(np.diag(affinity), 1)


def test_a_few_outliers_of_a_piece_change_nothing():
    distances = _distances()
    distances[:, :, [0, 10]] = np.random.default_rng(1).uniform(0, 50, (NUM_SETS, NUM_HYPOTHESES, 2))
    assert _affinity(distances)[0, 1] > 0.9


def test_sets_that_do_not_show_both_pieces_take_no_part():
    distances = _distances()
    distances[1:, :, PIECES == 1] = np.nan
    assert _affinity(distances)[0, 1] > 0.9
    distances[0, :, PIECES == 0] = np.nan
    assert _affinity(distances)[0, 1] == 0


def test_a_piece_of_one_trajectory_takes_part():
    pieces = np.append(PIECES, 3)
    distances = np.concatenate([_distances(), _distances()[:, :, -1:]], axis=2)
    assert _affinity(distances, pieces)[2, 3] > 0.5


def test_names_of_pieces_do_not_matter():
    swapped = _affinity(_distances(), 2 - PIECES)
    np.testing.assert_allclose(swapped, _affinity(_distances())[::-1, ::-1])


def test_the_median_of_a_piece_is_that_of_its_visible_trajectories():
    rng = np.random.default_rng(2)
    distances = rng.uniform(1, 2, (NUM_SETS, NUM_HYPOTHESES, len(PIECES)))
    distances[1, :, [0, 4, 5]] = distances[2, :, :9] = np.nan
    seen = ~np.isnan(distances[:, 0])
    params = PARAMS.model_copy(update={"min_tracks": 1, "num_tracks": 9})
    chosen = np.stack([np.flatnonzero(piece == PIECES)[np.linspace(0, 9, 9).round().astype(int)] for piece in range(3)])
    medians = _lower_medians(Residuals(distances), chosen, seen[:, chosen])
    for index, piece in np.ndindex(NUM_SETS, 3):
        own = distances[index][:, chosen[piece]]
        own = np.sort(own[:, ~np.isnan(own[0])], axis=1)
        if own.size:
            expected = distance_codes(own[:, (own.shape[1] - 1) // 2].astype(np.float32) ** 2)
            assert np.array_equal(medians[index, piece], expected)
    assert np.isfinite(_affinity(distances, params=params)).all()


@pytest.mark.parametrize(("count", "groups"), [(1, [0, 0, 0]), (2, [0, 0, 1]), (3, [0, 1, 2])])
def test_the_most_similar_pieces_are_merged_first(count, groups):
    affinity = np.array([[1, 0.8, 0.1], [0.8, 1, 0.2], [0.1, 0.2, 1]])
    merged = link_pieces(affinity)[count - 1]
    assert (merged[:, None] == merged).tolist() == (np.array(groups)[:, None] == groups).tolist()


def test_a_set_that_shows_few_trajectories_of_a_piece_takes_no_part():
    distances = _distances()
    distances[1:, :, 11:20], distances[1:, :10, 10] = np.nan, 5
    assert _affinity(distances)[0, 1] > 0.9


def test_of_an_even_number_the_lower_median_is_taken():
    distances = np.random.default_rng(0).uniform(1, 2, (1, NUM_HYPOTHESES, 4))
    medians = _lower_medians(Residuals(distances), np.arange(4)[None], np.ones((1, 1, 4), bool))
    expected = distance_codes(np.sort(distances[0], axis=1)[:, 1].astype(np.float32) ** 2)
    assert np.array_equal(medians[0, 0], expected)
