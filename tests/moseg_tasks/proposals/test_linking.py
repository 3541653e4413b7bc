from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.linking import LinkingParams
from moseg.tasks.proposals import count_overlaps, link_sections

PARAMS = LinkingParams()
SIDE = 20


def frames(**objects: tuple[int, int, int, int]) -> np.ndarray:
    """Two equal frames with rectangles (top, bottom, left, right), labelled by the number in their keyword."""
    masks = np.zeros((2, SIDE, SIDE), np.uint16)
    for name, (top, bottom, left, right) in objects.items():
        masks[:, top:bottom, left:right] = int(name.lstrip("o"))
    return masks


A, B, C = (1, 7, 1, 7), (9, 17, 2, 8), (3, 9, 11, 18)


def link(*boundaries: tuple[np.ndarray, np.ndarray], num_objects: list[int], params=PARAMS) -> np.ndarray:
    overlaps = [
        count_overlaps(masks0, masks1, num_objects[i], num_objects[i + 1])
        for i, (masks0, masks1) in enumerate(boundaries)
    ]
    return link_sections(overlaps, num_objects, params)


def test_counts_are_shared_pixels_and_their_sums_are_areas():
    counts = count_overlaps(frames(o1=(0, 4, 0, 10)), frames(o1=(2, 6, 0, 10), o2=(8, 10, 0, 5)), 1, 2)
    assert counts.dtype == np.int64
    assert counts.tolist() == [[2 * (400 - 40 - 20 - 10), 40, 20], [40, 40, 0]]


def test_counts_have_room_for_objects_unseen_in_the_shared_frames():
    assert count_overlaps(frames(), frames(), 3, 2).shape == (4, 3)


def test_identities_last_through_all_sections():
    identity = link(
        (frames(o1=A, o2=B), frames(o1=B, o2=A)), (frames(o1=B, o2=A), frames(o1=A, o2=B)), num_objects=[2, 2, 2]
    )
    assert identity.dtype == np.uint16
    assert identity.tolist() == [[0, 1, 2], [0, 2, 1], [0, 1, 2]]


def test_a_late_object_gets_a_new_identity():
    identity = link((frames(o1=A), frames(o1=C, o2=A)), num_objects=[1, 2])
    assert identity.tolist() == [[0, 1, 0], [0, 2, 1]]


def test_the_identity_of_an_ended_object_is_not_reused():
    identity = link((frames(o1=A, o2=B), frames(o1=B)), (frames(o1=B), frames(o1=B, o2=A)), num_objects=[2, 1, 2])
    assert identity.tolist() == [[0, 1, 2], [0, 2, 0], [0, 2, 3]]


def test_an_overlap_under_the_least_is_no_match():
    halves = (frames(o1=(0, 8, 0, 8)), frames(o1=(4, 12, 0, 8)))
    assert link(halves, num_objects=[1, 1], params=LinkingParams(min_iou=0.3)).tolist() == [[0, 1], [0, 1]]
    assert link(halves, num_objects=[1, 1], params=LinkingParams(min_iou=0.4)).tolist() == [[0, 1], [0, 2]]


def test_matching_is_one_to_one_and_the_best_in_sum():
    overlaps = [np.array([[0, 0, 0], [0, 80, 60], [0, 75, 0]])]
    assert link_sections(overlaps, [2, 2], LinkingParams(min_iou=0.1)).tolist() == [[0, 1, 2], [0, 2, 1]]


def test_sections_without_objects_break_no_law():
    assert link((frames(o1=A), frames()), (frames(), frames(o1=A)), num_objects=[1, 0, 1]).tolist() == [
        [0, 1],
        [0, 0],
        [0, 2],
    ]
    assert link_sections([], [], PARAMS).shape == (0, 1)
    assert link_sections([], [0], PARAMS).tolist() == [[0]]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_renumbering_the_objects_of_a_section_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    num_objects = [int(n) for n in rng.integers(0, 5, 4)]
    order = [np.concatenate([[0], 1 + rng.permutation(n)]) for n in num_objects]  # old label of each new one
    overlaps = [rng.integers(0, 10**9, (a + 1, b + 1)) for a, b in pairwise(num_objects)]
    renumbered = [counts[np.ix_(order[i], order[i + 1])] for i, counts in enumerate(overlaps)]
    loose = LinkingParams(min_iou=0.05)
    plain, permuted = link_sections(overlaps, num_objects, loose), link_sections(renumbered, num_objects, loose)
    pairs = {
        (int(plain[i, old]), int(permuted[i, new])) for i, olds in enumerate(order) for new, old in enumerate(olds)
    }
    assert len(pairs) == len({a for a, _ in pairs}) == len({b for _, b in pairs})


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_no_two_objects_of_a_section_share_an_identity(seed):
    rng = np.random.default_rng(seed)
    num_objects = [int(n) for n in rng.integers(0, 6, 5)]
    overlaps = [rng.integers(0, 50, (a + 1, b + 1)) for a, b in pairwise(num_objects)]
    identity = link_sections(overlaps, num_objects, LinkingParams(min_iou=0.01))
    for row, count in zip(identity, num_objects, strict=True):
        assert len(set(row[1 : count + 1])) == count and (row[1 : count + 1] > 0).all()
        assert row[0] == 0 and not row[count + 1 :].any()


def test_overlaps_that_do_not_fit_are_input_errors():
    with pytest.raises(InputError, match="do not fit"):
        link_sections([np.zeros((2, 2), np.int64)], [1, 2], PARAMS)
    with pytest.raises(InputError, match="do not share"):
        count_overlaps(frames(), frames()[:1], 1, 1)
