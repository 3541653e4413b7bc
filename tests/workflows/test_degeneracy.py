"""Fits that the data do not determine are reported with their reasons, for every stage."""

import numpy as np
import pytest

from moseg.tasks.geometry import Degeneracy
from moseg.workflows.runlog.degeneracy import REASONS, degenerate_event
from moseg.workflows.stages.fundamental import RANSAC_FIT

REF = f"fundamental/{'0' * 64}"
VALID = np.array([[True, False], [False, False]])


def test_invalid_fits_are_counted_by_reason():
    reason = np.array(
        [
            [Degeneracy.HOMOGRAPHY, Degeneracy.TOO_FEW_POINTS],
            [Degeneracy.COLLINEAR, Degeneracy.TOO_FEW_POINTS],
        ],
        dtype=np.uint8,
    )
    event = degenerate_event(REF, "fundamental", {"valid": VALID, "reason": reason})
    assert (event.ref, event.num_invalid, event.num_fits) == (REF, 3, 4)
    # A homography with a valid fit is not counted.
    assert event.reasons == {"too-few-points": 2, "collinear": 1}


def test_a_stage_without_reasons_has_its_invalid_fits_counted():
    event = degenerate_event(REF, "flow_model", {"valid": VALID})
    assert (event.num_invalid, event.num_fits, event.reasons) == (3, 4, {})


@pytest.mark.parametrize(
    "arrays", [{}, {"flow": np.zeros(3)}, {"valid": np.ones((2, 3), bool)}, {"valid": np.ones((0, 3), bool)}]
)
def test_an_artifact_without_invalid_fits_gives_no_event(arrays):
    assert degenerate_event(REF, "flow_model", arrays) is None


def test_only_the_stage_that_gives_reasons_has_them():
    assert set(REASONS) == {RANSAC_FIT.name}
