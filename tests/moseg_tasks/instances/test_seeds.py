import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.instances import SeedParams
from moseg.tasks.instances import merge_seeds

NOBODY = np.zeros(0, np.uint16)


def merge(tracked, identities, found, scores, num_identities=None, **params):
    tracked, found = (None if labels is None else np.array(labels, np.uint16) for labels in (tracked, found))
    identities = np.array(identities, np.uint16)
    if num_identities is None:
        num_identities = int(identities.max(initial=0))
    return merge_seeds(tracked, identities, num_identities, found, np.array(scores, float), SeedParams(**params))


def test_in_the_first_section_all_are_newcomers():
    seeds = merge(None, [], [[0, 1, 1, 2]], [0.9, 0.4])
    assert seeds.labels.tolist() == [[0, 1, 1, 2]]
    assert seeds.identities.tolist() == [1, 2] and seeds.num_identities == 2
    assert seeds.scores.tolist() == [0.9, 0.4] and seeds.found.tolist() == [1, 2]
    assert seeds.labels.dtype == seeds.identities.dtype == np.uint16


def test_an_object_found_again_can_keep_its_tracked_mask():
    seeds = merge([[0, 1, 1, 1, 0]], [7], [[1, 1, 1, 0, 0]], [0.9], refresh=False)
    assert seeds.labels.tolist() == [[0, 1, 1, 1, 0]]
    assert seeds.identities.tolist() == [7] and seeds.num_identities == 7
    assert seeds.scores.tolist() == [0.9] and seeds.found.tolist() == [1]


def test_an_object_found_again_keeps_its_identity_and_gets_the_found_mask():
    seeds = merge([[0, 1, 1, 1, 0]], [7], [[1, 1, 1, 0, 0]], [0.9])
    assert seeds.labels.tolist() == [[1, 1, 1, 0, 0]]
    assert seeds.identities.tolist() == [7] and seeds.num_identities == 7


def test_an_object_not_found_again_is_kept():
    for refresh in (False, True):
        seeds = merge([[1, 1, 0, 2, 2]], [3, 5], [[0, 0, 0, 1, 1]], [0.9], refresh=refresh)
        assert seeds.labels.tolist() == [[1, 1, 0, 2, 2]]
        assert seeds.identities.tolist() == [3, 5]
        assert seeds.scores.tolist() == [0, 0.9] and seeds.found.tolist() == [0, 1]


def test_an_object_that_is_no_longer_seen_ends_and_its_identity_is_not_used_again():
    seeds = merge([[0, 0, 2, 2]], [1, 2], [[1, 1, 0, 0]], [0.5], num_identities=2)
    assert seeds.identities.tolist() == [2, 3] and seeds.num_identities == 3
    assert seeds.labels.tolist() == [[2, 2, 1, 1]]


def test_identities_given_up_long_ago_are_not_used_again():
    assert merge([[1, 0]], [1], [[0, 1]], [0.5], num_identities=9).identities.tolist() == [1, 10]


def test_a_newcomer_gets_the_pixels_that_are_free():
    seeds = merge([[1, 1, 0, 0, 0, 0, 0]], [1], [[0, 1, 1, 1, 1, 1, 0]], [0.5])
    assert seeds.labels.tolist() == [[1, 1, 2, 2, 2, 2, 0]] and seeds.identities.tolist() == [1, 2]


def test_a_mask_mostly_on_tracked_objects_is_not_a_newcomer():
    tracked, found = [[1, 1, 0, 0, 0, 0, 0]], [[0, 1, 1, 1, 1, 1, 0]]
    assert merge(tracked, [1], found, [0.5], newcomer_share=0.81).identities.tolist() == [1]
    assert merge(tracked, [1], found, [0.5], newcomer_share=0.8).identities.tolist() == [1, 2]


def test_objects_are_matched_one_to_one_by_the_largest_overlap():
    seeds = merge([[1, 1, 1, 1, 0]], [4], [[1, 2, 2, 2, 2]], [0.9, 0.5], min_iou=0.1, refresh=False)
    assert seeds.identities.tolist() == [4] and seeds.found.tolist() == [2]


def test_too_little_overlap_is_no_match():
    tracked, found = [[1, 1, 0]], [[0, 1, 1]]
    assert merge(tracked, [1], found, [0.5], min_iou=0.34).found.tolist() == [0]
    assert merge(tracked, [1], found, [0.5], min_iou=0.33).found.tolist() == [1]


def test_labels_are_in_order_of_identity_whatever_the_tracks_order():
    seeds = merge([[1, 1, 2, 2]], [8, 3], [[0, 0, 0, 0]], [])
    assert seeds.labels.tolist() == [[2, 2, 1, 1]] and seeds.identities.tolist() == [3, 8]


def test_the_best_newcomers_fill_the_free_places():
    tracked, found = [[1, 0, 0, 0]], [[0, 1, 2, 3]]
    seeds = merge(tracked, [1], found, [0.2, 0.9, 0.5], max_objects=3)
    assert seeds.identities.tolist() == [1, 2, 3]
    assert seeds.found.tolist() == [0, 2, 3] and seeds.labels.tolist() == [[1, 0, 2, 3]]
    assert merge(tracked, [1], found, [0.2, 0.9, 0.5], max_objects=1).identities.tolist() == [1]


def test_no_found_and_no_tracked_objects_give_no_seeds():
    seeds = merge(None, [], [[0, 0]], [])
    assert not seeds.labels.any() and seeds.identities.shape == seeds.scores.shape == (0,)
    assert seeds.num_identities == 0


@pytest.mark.parametrize(
    ("tracked", "identities", "found", "scores", "given", "message"),
    [
        ([[1, 2]], [1], [[0, 0]], [], 1, "label without an object in tracked"),
        ([[1, 0]], [1], [[0, 2]], [0.5], 1, "label without an object in found"),
        ([[1, 0]], [1], [[0, 0, 0]], [], 1, "maps of labels differ in size"),
        ([[1, 0]], [4], [[0, 0]], [], 3, "identity that was not given"),
        ([[1, 0]], [1], [[0, 1]], [0.5], 65535, "more objects than identities"),
    ],
)
def test_input_that_contradicts_itself_is_refused(tracked, identities, found, scores, given, message):
    with pytest.raises(InputError, match=message):
        merge(tracked, identities, found, scores, given)


maps = hnp.arrays(np.uint16, (4, 5), elements=st.integers(0, 3))


@given(maps, maps, st.booleans(), st.floats(0.05, 1), st.floats(0.05, 1))
def test_identities_last_and_are_never_given_twice(tracked, found, refresh, min_iou, share):
    before = np.array([2, 4, 7], np.uint16)
    params = {"refresh": refresh, "min_iou": min_iou, "newcomer_share": share, "max_area": 1}
    seeds = merge(tracked, before, found, [0.9, 0.5, 0.1], num_identities=8, **params)
    identities = seeds.identities.tolist()
    assert identities == sorted(set(identities))
    assert set(identities) <= {*before.tolist(), *range(9, 12)}
    assert seeds.num_identities == 8 + sum(identity > 8 for identity in identities)
    assert np.unique(seeds.labels[seeds.labels > 0]).tolist() == list(range(1, len(identities) + 1))
    again = [source for source in seeds.found.tolist() if source]
    assert len(again) == len(set(again))
    if not refresh:
        kept = {identity: seeds.labels == label for label, identity in enumerate(identities, start=1)}
        for label, identity in enumerate(before.tolist(), start=1):
            if (tracked == label).any():
                np.testing.assert_array_equal(kept[identity], tracked == label)


@given(maps)
def test_found_masks_equal_to_tracked_ones_change_nothing(labels):
    _, labels = np.unique(np.append(labels, 0), return_inverse=True)
    labels = labels[:-1].reshape(4, 5)
    count = int(labels.max(initial=0))
    for refresh in (False, True):
        seeds = merge(labels, np.arange(1, count + 1), labels, np.ones(count), refresh=refresh, max_area=1)
        np.testing.assert_array_equal(seeds.labels, labels)
        assert seeds.num_identities == count


def test_a_mask_that_leaked_over_the_frame_does_not_hide_found_objects():
    tracked = np.ones((10, 10))
    tracked[0, :5] = 0
    found = np.zeros((10, 10))
    found[2:4, 2:4], found[6:9, 6:9] = 1, 2
    seeds = merge(tracked, [1], found, [0.9, 0.8])
    assert seeds.identities.tolist() == [2, 3]
    assert np.array_equal(seeds.labels, found)
    assert merge(tracked, [1], found, [0.9, 0.8], max_area=1).identities.tolist() == [1]


def test_a_speck_left_of_a_tracked_object_is_not_tracked_on():
    tracked = np.zeros((200, 200))
    tracked[0, :3] = 1
    tracked[50:60, 50:60] = 2
    assert merge(tracked, [1, 2], np.zeros((200, 200)), []).identities.tolist() == [2]


def test_a_found_mask_takes_nothing_from_another_tracked_object():
    seeds = merge([[1, 1, 1, 2, 2, 0]], [1, 2], [[1, 1, 1, 1, 1, 0]], [0.9])
    assert seeds.identities.tolist() == [1, 2]
    assert seeds.labels.tolist() == [[1, 1, 1, 2, 2, 0]]
