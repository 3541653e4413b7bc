"""Changes of masks are found at the frame at which they begin, and only once."""

import numpy as np
import pytest

from moseg.workflows.results.mask_history import ChangeKind, MaskChange, MaskHistory, find_changes

SHAPE = (40, 60)


def _find(areas, parts=None, at_edge=None):
    parts = [1] * len(areas) if parts is None else parts
    found = find_changes(areas, parts, [False] * len(areas) if at_edge is None else at_edge)
    return [(change.frame, change.kind.value, change.amount) for change in found]


def test_a_mask_that_keeps_its_area_does_not_change():
    assert _find([100, 104, 96, 100, 90, 110, 100]) == []
    # An object that recedes is no fault of its mask.
    assert _find([round(1000 * 0.95**frame) for frame in range(40)]) == []


def test_a_mask_shrinks_once_until_it_has_recovered():
    assert _find([100] * 6 + [40] * 4 + [45] * 3) == [(6, "shrinks", 40)]
    assert _find([100] * 6 + [40, 60, 45, 71] + [100] * 4 + [30]) == [(6, "shrinks", 40), (14, "shrinks", 30)]


def test_a_mask_that_is_gone_returns_or_does_not():
    assert _find([0, 50, 50, 0, 0, 0, 50, 50, 0]) == [(3, "vanishes", 3), (8, "vanishes", 0)]


def test_a_mask_splits_once_in_a_few_frames():
    parts = [1, 1, 3, 1, 2, 2, 1, 1, 2]
    assert _find([100] * 9, parts) == [(2, "splits", 3), (8, "splits", 2)]


def test_the_history_measures_masks():
    def frame(*boxes):
        labels = np.zeros(SHAPE, np.uint16)
        for identity, top, left, height, width in boxes:
            labels[top : top + height, left : left + width] = identity
        return labels

    history = MaskHistory()
    for left in (5, 6, 7):
        history.add(frame((7, 10, left, 10, 10), (300, 30, 40, 4, 4)))
    # Two halves and a crumb; the other one leaves through the border.
    history.add(frame((7, 10, 8, 10, 4), (7, 10, 20, 10, 4), (7, 30, 5, 1, 1), (300, 36, 40, 4, 1)))
    history.add(frame((7, 10, 8, 10, 4)))
    assert history.num_frames == 5 and history.identities() == (7, 300)
    assert history.areas(7).tolist() == [100, 100, 100, 81, 40]
    assert history.changes(7) == (
        MaskChange(3, ChangeKind.SPLITS, 2, False),
        MaskChange(4, ChangeKind.SHRINKS, 40, False),
    )
    assert history.changes(300) == (
        MaskChange(3, ChangeKind.SHRINKS, 25, True),
        MaskChange(4, ChangeKind.VANISHES, 0, True),
    )
    assert history.areas(9).tolist() == [0] * 5 and history.changes(9) == ()


@pytest.mark.parametrize("areas", [[], [0, 0], [5]])
def test_too_few_frames_have_no_changes(areas):
    assert _find(areas) == []
