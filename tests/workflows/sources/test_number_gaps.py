"""Missing frames, named from the numbers of the others."""

import pytest

from moseg.workflows.sources.number_gaps import find_gaps, gap_notes


@pytest.mark.parametrize(
    ("numbers", "gaps"),
    [
        ([*range(12), *range(15, 20)], ((12, 14),)),
        ([1, 2, 3, 5, 6, 7, 10, 11, 12], ((4, 4), (8, 9))),
        ([0, 5, 10, 15, 30, 35], ((20, 25),)),
        ([0, 5, 10, 15, 22, 27, 32], ()),
        ([*range(100, 120)], ()),
        # Time stamps.
        ([1305031102175, 1305031102211, 1305031102243, 1305031102275, 1305031102311], ()),
        ([0, 1, 3, 4, 6, 7], ((2, 2), (5, 5))),
        ([0, 2, 3, 9], ()),
        ([3, 2, 1], ()),
        ([1, 1, 1, 1], ()),
        ([None, 1, 2, 9], ()),
        ([0, 9], ()),
        ([], ()),
    ],
)
def test_a_gap_is_what_is_missing_from_equal_steps(numbers, gaps):
    assert find_gaps(numbers) == gaps


def test_the_note_names_the_frames():
    paths = [f"walk/frame_{number:04d}.png" for number in range(20) if number not in (12, 13, 14, 17)]
    (note,) = gap_notes(paths)
    assert note.startswith("frames 12-14, 17 missing in walk: ")
    assert gap_notes([f"walk/{number}.jpg" for number in range(9) if number != 4])[0].startswith("frame 4 missing")
    assert gap_notes(["a.png", "b.png", "c.png"]) == ()


def test_of_many_gaps_the_first_are_named():
    (note,) = gap_notes([f"walk/{number}.png" for number in range(100) if number % 10 != 5])
    assert note.startswith("frames 5, 15, 25, 35, 45 and 5 further gaps missing in walk")
