"""Growth of objects by the flow inside their masks."""

import numpy as np
import pytest

from moseg.tasks.saliency import flow_growth

SHAPE = (60, 90)
LABELS = np.zeros(SHAPE, np.uint16)
LABELS[5:35, 10:40], LABELS[10:50, 50:80] = 1, 2


def flow_to_previous(*growths):
    """Return the flow of objects whose areas are these times as large as in the frame before, and which move."""
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(float)
    flow = np.zeros((*SHAPE, 2), np.float32)
    for label, growth in enumerate(growths, start=1):
        inside = label == LABELS
        offset = np.stack([x - x[inside].mean(), y - y[inside].mean()], axis=-1)
        flow[inside] = ((1 / np.sqrt(growth) - 1) * offset + [7, -3])[inside]
    return flow


@pytest.mark.parametrize("growths", [(1, 1), (0.8, 1.3), (0.97, 0.5)])
def test_each_object_grows_as_its_flow_says(growths):
    found = flow_growth(LABELS, flow_to_previous(*growths), 4)
    np.testing.assert_allclose(found[1:3], np.log(growths), atol=1e-4)
    assert np.isnan(found[[0, 3]]).all()


def test_growth_is_no_more_than_fourfold():
    np.testing.assert_allclose(flow_growth(LABELS, flow_to_previous(9, 0.1), 3)[1:], [np.log(4), -np.log(4)])


def stretched(slope_x, slope_y):
    """Return the flow to the previous frame in which the first object is stretched along x and y."""
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(np.float32)
    return np.stack([slope_x * (x - 25), slope_y * (y - 20)], axis=-1)


@pytest.mark.parametrize(("slopes", "growth"), [((0.2, 0), 1), ((0.2, -0.1), 1), ((0.2, 0.1), 1 / 1.1**2)])
def test_what_both_axes_agree_on_is_growth(slopes, growth):
    """Parts that move towards each other make nothing smaller: one of them may have stopped."""
    assert flow_growth(LABELS, stretched(*slopes), 3)[1] == pytest.approx(np.log(growth), abs=1e-4)


def test_a_flow_that_folds_over_says_nothing():
    assert np.isnan(flow_growth(LABELS, stretched(-1.5, 0.1), 3)[1])


def test_it_is_unknown_without_flow_and_for_a_few_pixels():
    assert np.isnan(flow_growth(LABELS, None, 3)).all()
    labels = np.zeros(SHAPE, np.uint16)
    labels[:2, :5] = 1
    assert np.isnan(flow_growth(labels, flow_to_previous(1, 1), 2)).all()
