import numpy as np
import pytest

from moseg.schemas.parameters import CarryingParams
from moseg.tasks.corrections.own_motion import strays_from_mask

SHAPE = (40, 60)
COVERED = 0.02


@pytest.fixture
def share():
    """A mask of 20 x 20 cells, of which the last five columns do not move with the others."""
    share = np.zeros(SHAPE, np.float32)
    share[10:30, 20:40] = 1
    return share


def flow_of(*, inside: tuple[float, float], outside: tuple[float, float]) -> np.ndarray:
    flow = np.full((*SHAPE, 2), outside, np.float32)
    flow[10:30, 20:35] = inside
    return flow


def test_cells_that_follow_the_surroundings_do_not_belong_to_the_mask(share):
    params = CarryingParams()
    evidence = strays_from_mask(flow_of(inside=(2, 0), outside=(-1, 0)), share, COVERED, params)
    np.testing.assert_allclose(evidence[12:28, 36:39], -params.motion)
    np.testing.assert_array_equal(evidence[12:28, 22:33], 0)


def test_nothing_speaks_against_cells_if_all_move_alike(share):
    evidence = strays_from_mask(flow_of(inside=(2, 1), outside=(2, 1)), share, COVERED, CarryingParams())
    np.testing.assert_allclose(evidence, 0, atol=1e-4)


def test_too_few_cells_give_no_evidence(share):
    flow = flow_of(inside=(2, 0), outside=(-1, 0))
    assert not strays_from_mask(flow, np.zeros_like(share), COVERED, CarryingParams()).any()
