"""Sections of a video: runs of `l` frames in which objects are proposed anew."""

from typing import NamedTuple

from moseg.schemas.configs import SectionParams


class Section(NamedTuple):
    """Frames start..stop belong to the section; its proposals reach to `proposal_stop` for linking with the next."""

    start: int
    stop: int
    proposal_stop: int


def cut_sections(num_frames: int, params: SectionParams) -> tuple[Section, ...]:
    """Sections of `params.length` frames that cover the video; the last one may be shorter."""
    sections = []
    for start in range(0, num_frames, params.length):
        stop = min(start + params.length, num_frames)
        sections.append(Section(start, stop, min(stop + params.overlap, num_frames)))
    return tuple(sections)
