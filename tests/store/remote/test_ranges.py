"""Parts of one object: read together where they are near, and short where the object ends early."""

import numpy as np
import pytest

from moseg.store.packing import Range
from moseg.store.remote.requests import NEAR_BYTES, Requests

CONTENT = np.random.default_rng(0).bytes(3 * NEAR_BYTES)
PARTS = {
    "last": Range(len(CONTENT) - 7, 7),
    "first": Range(0, 5),
    "near": Range(9, 4),
    "far": Range(2 * NEAR_BYTES, 11),
    "empty": Range(3, 0),
    "overlapping": Range(2 * NEAR_BYTES + 5, 100),
}


@pytest.fixture
def requests(s3):
    return Requests(s3)


@pytest.mark.parametrize("length", [len(CONTENT), len(CONTENT) - 3, 2 * NEAR_BYTES + 6, 2 * NEAR_BYTES, 12, 9, 1, 0])
def test_parts_are_those_of_what_is_there(requests, length):
    content = CONTENT[:length]
    requests.put("object", content)
    expected = {name: content[start : start + nbytes] for name, (start, nbytes) in PARTS.items()}
    assert requests.get_ranges("object", PARTS) == expected


def test_a_missing_object_has_no_parts(requests):
    assert requests.get_ranges("missing", PARTS) is None
    assert requests.get_ranges("missing", {"empty": Range(0, 0)}) is None
