"""Golden digests: a change of any of these makes every stored artifact unreachable."""

from functools import partial
from hashlib import blake2b

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg.schemas.digests import (
    canonical_json,
    digest_array,
    digest_blocks,
    digest_bytes,
    digest_json,
    domain_tag,
    hash_array,
)

OF_ARRAYS = pytest.mark.parametrize("digest", [partial(digest_array, "golden"), hash_array])
SCALARS = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()


def test_golden_digest_of_bytes():
    assert digest_bytes("golden") == "12d048a9a86683b2b30cb0bff9e4895aec192de3a2bbe0405fd869779717c8bc"
    assert digest_bytes("golden", b"ab", b"c") == "4232fec2edf08e49c5bc73992963f2b710038849eec1f9a8f429af5e47e63bb3"


def test_golden_digest_of_json():
    value = {"b": [1, 2.5, None, True, "é"], "a": -0.0}
    assert digest_json("golden", value) == "6eb6f96ce717788559ca593a215b332b8cc411a007e9ef9f9b5115a6fdd484db"


def test_golden_digest_of_an_array():
    array = np.arange(6, dtype=np.float32).reshape(2, 3)
    assert digest_array("golden", array) == "7ac48c407f4503c9ffaf0b31eba0b8fd92454eee3f39b6297bb06e37161a7f4c"
    assert hash_array(array) == "sha256:78c0cbdba22fac72cd5662e45e7247e9283f07c0af41f8a3087fd556b0d44a33"


def test_digest_is_blake2b_of_length_prefixed_parts_under_the_domain():
    expected = blake2b(digest_size=32, person=b"moseg:golden")
    expected.update((2).to_bytes(8, "little") + b"ab" + (1).to_bytes(8, "little") + b"c")
    assert digest_bytes("golden", b"ab", b"c") == expected.hexdigest()


@pytest.mark.parametrize("blocks", [[], [b""], [b"abc"], [b"a", b"", b"bc"]])
def test_blocks_of_one_part_have_its_digest(blocks):
    part = b"".join(blocks)
    assert digest_blocks("golden", len(part), blocks) == digest_bytes("golden", part)


@pytest.mark.parametrize("num_bytes", [2, 4])
def test_blocks_of_another_length_are_refused(num_bytes):
    with pytest.raises(ValueError, match=f"3 instead of {num_bytes} bytes"):
        digest_blocks("golden", num_bytes, [b"a", b"bc"])


def test_parts_and_domains_do_not_run_together():
    digests = {digest_bytes("a", b"ab", b"c"), digest_bytes("a", b"a", b"bc"), digest_bytes("a", b"abc")}
    assert len(digests | {digest_bytes("b", b"abc")}) == 4


def test_domain_longer_than_the_tag_is_refused():
    assert domain_tag("0123456789") == b"moseg:0123456789"
    with pytest.raises(ValueError, match="10 characters"):
        domain_tag("01234567890")


def test_canonical_json_is_sorted_utf8_without_blanks():
    assert canonical_json({"b": [1, 1.0, True], "a": {"ü": None}}) == '{"a":{"ü":null},"b":[1,1.0,true]}'.encode()


@given(st.dictionaries(st.text(), SCALARS))
def test_order_of_keys_does_not_matter(value):
    assert canonical_json(value) == canonical_json(dict(reversed(value.items())))


@pytest.mark.parametrize(("left", "right"), [(1, 1.0), (1, True), (0, False), (0.0, -0.0), ("1", 1), (None, "null")])
def test_values_that_compare_equal_have_different_digests(left, right):
    assert digest_json("golden", [left]) != digest_json("golden", [right])


def test_tuples_are_lists():
    assert canonical_json((1, (2, 3))) == canonical_json([1, [2, 3]])


@pytest.mark.parametrize(
    "value", [{1, 2}, b"bytes", np.float64(1.0), np.int64(1), np.zeros(2), {1: 2}, {None: 1}, object(), 1j]
)
def test_what_json_would_not_keep_is_a_type_error(value):
    for nested in (value, [value], {"a": [value]}):
        with pytest.raises(TypeError):
            canonical_json(nested)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_numbers_that_json_lacks_are_a_value_error(value):
    with pytest.raises(ValueError, match="JSON has no such number"):
        canonical_json({"a": [value]})


@OF_ARRAYS
def test_layout_in_memory_does_not_change_an_arrays_digest(digest):
    array = np.arange(24, dtype=np.int32).reshape(4, 6)
    expected = digest(array)
    assert digest(np.asfortranarray(array)) == expected
    assert digest(array.astype(">i4")) == expected
    assert digest(np.repeat(array, 2, axis=1)[:, ::2]) == expected


@OF_ARRAYS
def test_dtype_and_shape_are_part_of_an_arrays_digest(digest):
    array = np.zeros((2, 3), np.int32)
    views = [array, array.reshape(3, 2), array.reshape(6), array.view(np.float32), array.view(np.uint32)]
    empty = [np.zeros((0, 3)), np.zeros((3, 0)), np.zeros(0), np.zeros(()), np.zeros(1)]
    assert len({digest(each) for each in views + empty}) == len(views + empty)


@OF_ARRAYS
def test_object_arrays_have_no_digest(digest):
    with pytest.raises(TypeError, match="object"):
        digest(np.array([None]))
