"""Sections cover a video, each frame once, and share frames for linking."""

from itertools import chain, pairwise

from hypothesis import given
from hypothesis import strategies as st

from moseg.schemas.configs import SectionParams
from moseg.workflows.graph.sections import Section, cut_sections

PARAMS = st.builds(SectionParams, length=st.integers(1, 40), overlap=st.integers(1, 12))
NUM_FRAMES = st.integers(0, 200)


@given(NUM_FRAMES, PARAMS)
def test_every_frame_is_in_exactly_one_section(num_frames, params):
    sections = cut_sections(num_frames, params)
    frames = chain.from_iterable(range(section.start, section.stop) for section in sections)
    assert list(frames) == list(range(num_frames))


@given(NUM_FRAMES, PARAMS)
def test_frame_m_is_frame_m_modulo_length_of_its_section(num_frames, params):
    for index, section in enumerate(cut_sections(num_frames, params)):
        assert section.start == index * params.length
        assert 0 < section.stop - section.start <= params.length


@given(NUM_FRAMES, PARAMS)
def test_proposals_stay_inside_the_video(num_frames, params):
    for section in cut_sections(num_frames, params):
        assert section.stop <= section.proposal_stop <= num_frames
        assert section.proposal_stop - section.stop <= params.overlap


@given(NUM_FRAMES, PARAMS)
def test_neighbours_share_frames_that_both_have_proposals_for(num_frames, params):
    for section0, section1 in pairwise(cut_sections(num_frames, params)):
        num_shared = section0.proposal_stop - section1.start
        assert 1 <= num_shared <= params.overlap
        assert section0.proposal_stop <= section1.proposal_stop


def test_a_video_of_ten_frames():
    params = SectionParams(length=4, overlap=1)
    assert cut_sections(10, params) == (Section(0, 4, 5), Section(4, 8, 9), Section(8, 10, 10))
