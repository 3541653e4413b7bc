"""Maps of frames that are read where they are indexed give what the whole stack would give."""

import numpy as np
import pytest

from moseg.tasks.half_floats import to_float32
from moseg.workflows.stages.frame_rows import FrameRows

STACK = np.random.default_rng(0).normal(size=(6, 2, 8, 10, 2)).astype(np.float16)


@pytest.fixture
def read_frames():
    return []


@pytest.fixture
def rows(read_frames):
    def read(frame):
        read_frames.append(frame)
        return STACK[frame]

    return FrameRows(STACK.shape, read, to_float32)


@pytest.mark.parametrize(
    "index",
    [
        (3, 1, slice(2, 5), slice(1, 9)),
        (3, 1, 4, 5),
        (5, 0, slice(None, None, 4), slice(None, None, 4)),
        (slice(1, 4), slice(None), slice(2, 5), slice(0, 3)),
    ],
)
def test_a_part_is_that_of_the_stack(rows, index):
    part = rows[index]
    assert part.dtype == np.float32 and np.array_equal(part, STACK[index].astype(np.float32))


def test_only_the_frames_asked_for_are_read(rows, read_frames):
    assert rows.shape == STACK.shape
    rows[slice(2, 4), 0], rows[5, 1]
    assert read_frames == [2, 3, 5]
