"""Changes from frame to frame, and those that only coding again makes."""

import itertools

import numpy as np
import pytest

from moseg.schemas.parameters import RepetitionParams
from moseg.tasks.repetitions import find_repetitions, mean_change

PARAMS = RepetitionParams()


def _changes(shown, small=0.5, large=10.0):
    """Return the changes of frames that show these pictures."""
    return [small if picture0 == picture1 else large for picture0, picture1 in itertools.pairwise(shown)]


@pytest.mark.parametrize(
    "shown", ["aabbccddeeffgghh", "aabbbccdddeefff", "abcddefghhijkllm", "aaaabbbbccccdddd", "aabbb", "abcdefghhhhh"]
)
def test_frames_of_one_picture_are_repetitions(shown):
    expected = [index for index, change in enumerate(_changes(shown)) if change < 1]
    assert find_repetitions(_changes(shown), PARAMS) == expected


@pytest.mark.parametrize(
    "changes",
    [
        [10.0] * 20,
        # A camera that stops, and one that starts.
        [10.0] * 12 + [0.5] * 12,
        [0.5] * 12 + [10.0] * 12,
        # A slow frame among faster ones.
        [10.0] * 8 + [2.0] + [10.0] * 8,
        # A scene in which nothing moves is coded better in some frames than in others.
        [0.01, 0.01, 0.3] * 8,
        [0.0] * 20,
        [0.5],
    ],
    ids=["moves", "stops", "starts", "slows", "still", "one picture", "two frames"],
)
def test_what_moves_less_is_no_repetition(changes):
    assert find_repetitions(changes, PARAMS) == []


def test_the_ends_of_a_part_that_reaches_a_window_farther_are_judged_as_within_the_whole():
    changes = _changes("aabbbccdddeefffgghhhiijjjkklllmm")
    part = changes[4:-4]
    window = PARAMS.window
    judged = range(window, len(part) - window)
    found = set(find_repetitions(part, PARAMS)) & {*judged}
    assert found == {index - 4 for index in find_repetitions(changes, PARAMS)} & {*judged}


def test_the_change_is_the_mean_difference_of_the_rows_read():
    image0, image1 = np.zeros((2, 6, 4, 3), np.uint8)
    image1[::2] = 6
    assert mean_change(image0, image1, 2) == 6
    assert mean_change(image0, image1, 1) == 3
