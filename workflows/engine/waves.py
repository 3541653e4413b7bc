"""Waves: groups of sequences that are planned and computed together.

A plan holds some kilobytes for every frame pair, in the client and in the pin that protects its artifacts. So a large
data set is planned one wave at a time; the next wave finds the artifacts that sequences share in the store.
"""

from collections.abc import Iterator, Sequence

from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import Session

FRAMES = 4096
"""Smallest limit of frames a wave: they take minutes, compared with which the seconds at a wave's end are few."""
FRAMES_PER_WORKER = 1024
"""The limit for a large cluster, so that each worker has minutes of work too."""


def in_waves(session: Session, sources: Sequence[SequenceSource]) -> Iterator[list[SequenceSource]]:
    """Yield the waves of a session, and report each if there are several."""
    waves = list(cut_waves(sources, session.runner.num_workers()))
    for number, wave in enumerate(waves, start=1):
        if len(waves) > 1:
            session.report(f"wave {number} of {len(waves)}: {len(wave)} sequences, {wave[0].name} to {wave[-1].name}")
        yield wave


def cut_waves(sources: Sequence[SequenceSource], num_workers: int) -> Iterator[list[SequenceSource]]:
    """Yield sequences in their order: as many at a time as fit into a wave, or one that is longer than a wave."""
    if len(sources) == 1:
        # Of any length; to count the frames of a video takes decoding it.
        yield list(sources)
        return
    limit = max(FRAMES, FRAMES_PER_WORKER * num_workers)
    wave: list[SequenceSource] = []
    num_frames = 0
    for source in sources:
        count = source.frames.num_frames()
        if wave and num_frames + count > limit:
            yield wave
            wave, num_frames = [], 0
        wave.append(source)
        num_frames += count
    if wave:
        yield wave
