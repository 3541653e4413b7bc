"""Logits of the motion network, carried along the flow to frames that it does not look at."""

import numpy as np

from moseg.tasks.motion_network import carry_logits

GRID, WORKING = (24, 32), (48, 64)


def blob(column: int) -> np.ndarray:
    """Return a logit float32 of GRID that is 3 in a square at a column, else -3."""
    logit = np.full(GRID, -3, np.float32)
    logit[8:16, column : column + 8] = 3
    return logit


def uniform_flow(x: float) -> np.ndarray:
    """Return a flow of WORKING to the right, px of that grid per frame."""
    return np.full((*WORKING, 2), (x, 0), np.float32)


def test_a_logit_moves_with_the_flow_that_is_finer_than_its_grid():
    # An object at column 10 here is at column 6 in the frame before: 4 cells, 8 px of the working grid.
    np.testing.assert_allclose(carry_logits([blob(6)], [uniform_flow(-8)]), blob(10))


def test_what_both_neighbours_carry_is_averaged():
    both = carry_logits([blob(6), blob(14)], [uniform_flow(-8), uniform_flow(4)])
    np.testing.assert_allclose(both, (blob(10) + blob(12)) / 2)


def test_the_neighbours_are_not_changed():
    logit, flow = blob(6), uniform_flow(3)
    carry_logits([logit], [flow])
    assert np.array_equal(logit, blob(6)) and np.array_equal(flow, uniform_flow(3))
