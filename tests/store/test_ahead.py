"""Concurrent reads of many artifacts."""

import pytest

from moseg.store.ahead import map_ahead


def test_map_ahead_keeps_the_order_and_starts_few_calls():
    begun, taken = [], []
    for result in map_ahead(lambda item: begun.append(item) or item * item, iter(range(50)), 3):
        taken.append(result)
        assert len(begun) <= len(taken) + 6
    assert taken == [item * item for item in range(50)]


def test_map_ahead_raises_the_error_of_a_call():
    with pytest.raises(ZeroDivisionError):
        list(map_ahead(lambda item: 1 // item, [1, 0, 1], 2))
