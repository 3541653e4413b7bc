"""Waves: runs of sequences that are planned and computed together.

A plan holds some kilobytes for every frame pair, in the client and in the pin that protects its artifacts. So a large
data set is planned a part at a time; what sequences share is found in the store by the next part.
"""

from collections.abc import Iterator, Sequence

from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import Session

FRAMES = 4096
"""Frames of a wave at least: beside the minutes that they take, the seconds in which a wave runs out are few."""
FRAMES_PER_WORKER = 1024
"""Of a large cluster, so that each worker has minutes of work too."""


def in_waves(session: Session, sources: Sequence[SequenceSource]) -> Iterator[list[SequenceSource]]:
    """The waves of a session, each told of where there are several."""
    waves = list(cut_waves(sources, session.num_workers()))
    for number, wave in enumerate(waves, start=1):
        if len(waves) > 1:
            session.tell(f"wave {number} of {len(waves)}: {len(wave)} sequences, {wave[0].name} to {wave[-1].name}")
        yield wave


def cut_waves(sources: Sequence[SequenceSource], num_workers: int) -> Iterator[list[SequenceSource]]:
    """Sequences in their order, as many at a time as have no more frames together than a wave, or one that has more."""
    if len(sources) == 1:
        # Whatever its length; frames of a video are counted by decoding it.
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
