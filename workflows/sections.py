"""Sections of a video: runs of `l` frames in which objects are proposed anew."""

from typing import NamedTuple

from schemas.configs import SectionParams


class Section(NamedTuple):
    """Frames start..stop belong to the section; its proposals reach to `proposal_stop` for linking with the next.

    Saliency is accumulated from `context_start` to `context_stop`.
    """

    start: int
    stop: int
    proposal_stop: int
    context_start: int
    context_stop: int


def cut_sections(num_frames: int, params: SectionParams) -> tuple[Section, ...]:
    """Sections of `params.length` frames that cover the video; the last one may be shorter."""
    sections = []
    for start in range(0, num_frames, params.length):
        stop = min(start + params.length, num_frames)
        proposal_stop = min(stop + params.overlap, num_frames)
        sections.append(
            Section(
                start,
                stop,
                proposal_stop,
                max(start - params.context, 0),
                min(proposal_stop + params.context, num_frames),
            )
        )
    return tuple(sections)
