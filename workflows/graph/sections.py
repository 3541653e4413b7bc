"""Sections of a video: runs of `l` frames with object proposals of their own."""

from bisect import bisect_right
from collections.abc import Sequence
from operator import attrgetter
from typing import NamedTuple

from moseg.schemas.configs import SectionParams


class Section(NamedTuple):
    """Section of the frames start..stop; its proposals extend to `proposal_stop`, for linking with the next section."""

    start: int
    stop: int
    proposal_stop: int


def cut_sections(num_frames: int, params: SectionParams) -> tuple[Section, ...]:
    """Return sections of `params.length` frames that cover the video; the last one may be shorter."""
    sections = []
    for start in range(0, num_frames, params.length):
        stop = min(start + params.length, num_frames)
        sections.append(Section(start, stop, min(stop + params.overlap, num_frames)))
    return tuple(sections)


def place_frame(sections: Sequence[Section], frame: int) -> tuple[int, int]:
    """Return the section that a frame belongs to, and its row there."""
    index = bisect_right(sections, frame, key=attrgetter("start")) - 1
    return index, frame - sections[index].start
