"""Reading many artifacts at the same time."""

import pytest

from moseg.store.ahead import map_ahead


def test_a_map_ahead_keeps_the_order_and_begins_few():
    begun, taken = [], []
    for result in map_ahead(lambda item: begun.append(item) or item * item, iter(range(50)), 3):
        taken.append(result)
        assert len(begun) <= len(taken) + 6
    assert taken == [item * item for item in range(50)]


def test_a_map_ahead_hands_on_what_a_call_raises():
    with pytest.raises(ZeroDivisionError):
        list(map_ahead(lambda item: 1 // item, [1, 0, 1], 2))
