"""Parts of an object that one section found apart have one identity where its neighbour has one object."""

import numpy as np
import pytest

from moseg.schemas.parameters.identity import IdentityParams
from moseg.schemas.parameters.linking import LinkingParams
from moseg.tasks.proposals.linking import link_sections
from moseg.tasks.proposals.parts import join_parts
from moseg.tasks.proposals.returning import Sightings, find_returns

LINKING, PARAMS = LinkingParams(), IdentityParams()


def see(*spans):
    """Sightings of objects from a first to a last frame, or unseen ones (-1, -1); they look alike and stand still."""
    frames = np.array([[(first, first), (last, last)] for first, last in spans], np.int32)
    count = len(spans)
    colours = np.zeros((count, 2, 8, 32, 32), np.float16)
    colours[..., 0, 0, 0] = 1
    places = np.tile(np.float32([50, 50, 0, 0, 400]), (count, 2, 1))
    return Sightings(frames, places, colours, np.zeros((30, 2), np.float32))


def join(overlaps, seen, linking=LINKING, params=PARAMS):
    overlaps = [np.array(counts) for counts in overlaps]
    num_objects = [len(overlaps[0]) - 1, *(counts.shape[1] - 1 for counts in overlaps)]
    return join_parts(link_sections(overlaps, num_objects, linking), overlaps, seen, linking, params).tolist()


# The whole has 90 px in the shared frames; the second part, which is found first, has 50 of them, and the first 40.
APART = [[1000, 0, 0], [0, 50, 40]]
WHOLE, PARTS = see((0, 29)), see((6, 19), (0, 9))


def test_a_part_that_the_matched_one_continues_has_the_identity_of_the_whole():
    assert join([APART], [WHOLE, PARTS]) == [[0, 1, 0], [0, 1, 1]]


def test_a_later_part_has_it_too():
    assert join([APART], [WHOLE, see((0, 9), (6, 19))]) == [[0, 1, 0], [0, 1, 1]]


def test_parts_of_the_section_before_are_joined_by_the_one_after():
    assert join([np.transpose(APART)], [PARTS, WHOLE]) == [[0, 1, 1], [0, 1, 0]]


def test_three_parts_are_joined_one_after_the_other_and_the_others_have_numbers_without_gaps():
    counts = [[1000, 0, 0, 0, 20], [0, 50, 30, 20, 0]]
    seen = [WHOLE, see((8, 15), (0, 9), (14, 29), (20, 29))]
    assert join([counts], seen) == [[0, 1, 0, 0, 0], [0, 1, 1, 1, 2]]


def test_an_identity_that_began_before_is_joined_in_all_sections():
    # The part's identity began in a section of its own before, and both go on.
    overlaps = [[[1000, 0, 0], [0, 0, 40]], np.transpose(APART), [[1000, 0], [0, 90]]]
    seen = [see((20, 29)), PARTS, WHOLE, WHOLE]
    assert join(overlaps, seen) == [[0, 1, 0], [0, 1, 1], [0, 1, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("counts", "parts"),
    [
        pytest.param(APART, see((0, 29), (0, 29)), id="seen together"),
        pytest.param(APART, see((0, 29), (5, 12)), id="seen while the other is"),
        pytest.param(APART, see((12, 29), (0, 29)), id="seen together for too long"),
        pytest.param(APART, see((25, 29), (0, 9)), id="too long after"),
        pytest.param([[1000, 0, 12], [0, 50, 40]], PARTS, id="not inside"),
        pytest.param([[1000, 0, 0, 0], [0, 50, 0, 0], [0, 0, 0, 40]], see((6, 19), (0, 29), (0, 9)), id="of another"),
    ],
)
def test_other_objects_stay_apart(counts, parts):
    whole = see(*[(0, 29)] * (len(counts) - 1))
    identity = join([counts], [whole, parts])
    assert len(set(identity[1]) - {0}) == len(parts.frames)


def test_an_object_that_the_shared_frames_do_not_show_stays_apart():
    assert join([[[1000, 0, 0], [0, 50, 0]]], [WHOLE, see((0, 9), (10, 29))]) == [[0, 1, 0], [0, 1, 2]]


def test_an_object_that_is_matched_to_another_stays_apart():
    counts, linking = [[1000, 0, 0], [0, 50, 17], [0, 0, 3]], LINKING.model_copy(update={"min_iou": 0.1})
    assert join([counts], [see((0, 29), (0, 29)), PARTS], linking) == [[0, 1, 2], [0, 1, 2]]


def test_parts_of_an_object_to_which_none_is_matched_stay_apart():
    counts = [[1000, 0, 0], [200, 40, 40]]
    assert join([counts], [WHOLE, PARTS]) == [[0, 1, 0], [0, 2, 3]]


def test_identities_that_were_joined_before_are_joined_with_all_their_parts():
    # The second section has the first one's objects 2 and 3 as one, and the third section that and object 1.
    overlaps = [[[1000, 0, 0], [0, 90, 0], [0, 0, 50], [0, 0, 40]], [[1000, 0], [0, 50], [0, 40]]]
    seen = [see((0, 29), (0, 9), (6, 19)), see((0, 9), (6, 19)), WHOLE]
    assert join(overlaps, seen) == [[0, 1, 1, 1], [0, 1, 1, 0], [0, 1, 0, 0]]


def test_unseen_objects_those_without_sightings_and_all_without_a_share_stay_apart():
    for seen, linking in (
        ([WHOLE, see((-1, -1), (0, 9))], LINKING),
        ([WHOLE, None], LINKING),
        ([WHOLE, PARTS], LINKING.model_copy(update={"part_share": 0})),
    ):
        assert join([APART], seen, linking) == [[0, 1, 0], [0, 1, 2]]


def test_an_object_of_parts_returns_where_the_first_of_them_begins():
    """The first part has the higher label; a gap that is too long for it is none for the other."""
    identity = np.array([[0, 1, 0], [0, 2, 2]], np.uint16)
    seen, params = (see((0, 9)), see((25, 29), (10, 26))), PARAMS.model_copy(update={"return_gap": 30})
    assert find_returns(identity, (0, 30), seen, 10_000, params).tolist() == [[0, 1, 0], [0, 1, 1]]
    seen = (see((0, 9), (25, 29)), see((25, 29)))
    identity = np.array([[0, 1, 1], [0, 2, 0]], np.uint16)
    assert find_returns(identity, (0, 30), seen, 10_000, params).tolist() == [[0, 1, 1], [0, 1, 0]]
