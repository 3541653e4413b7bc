"""The purpose of a run, as its log records it."""

from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.schemas.events import SequenceSubject, SubjectEvent, VideoFrames
from moseg.schemas.frozen import Frozen
from moseg.workflows.graph import SequenceLeaves, TrajectoryLeaves
from moseg.workflows.runlog.events import as_unicode, this_process
from moseg.workflows.weights.leaves_by_name import LeavesByName


class Purpose(NamedTuple):
    """Which command runs, and what is known of its data beforehand.

    Attributes
    ----------
    command : 'eval', 'ablate' or 'segment'
    notes : tuple of str
        What a reader must know to read its figures rightly.
    fps : float or None
        Frames per second, in place of those that its data have.
    words : tuple of str or None
        Command line without `moseg` that leads to the same, of a run that continues another.
    video : str or None
        Digest of the user's video.
    uncorrected : PipelineConfig or None
        The configuration before the settings of the user's corrections, if there are any.
    video_frames : VideoFrames or None
        The frames that are read of the user's video, if they are known.
    """

    command: Literal["eval", "ablate", "segment"]
    notes: tuple[str, ...] = ()
    fps: float | None = None
    words: tuple[str, ...] | None = None
    video: str | None = None
    uncorrected: PipelineConfig | None = None
    video_frames: VideoFrames | None = None


EVALUATION = Purpose("eval")
SEGMENTATION = Purpose("segment")


def make_subject(
    purpose: Purpose,
    dataset: str | None,
    config: PipelineConfig,
    variants: Sequence[Variant | TrajectoryVariant],
    sequences: Sequence[tuple[SequenceLeaves | TrajectoryLeaves, float | None]],
    seeds: Sequence[int] | None = None,
) -> SubjectEvent:
    """Return the line of a run's log about some of its sequences, each with its frames per second where it has any."""
    return SubjectEvent(
        command=purpose.command,
        dataset=dataset,
        variants=tuple(variant.value for variant in variants),
        config=config.model_dump(mode="json"),
        seeds=None if seeds is None else tuple(seeds),
        notes=tuple(map(as_unicode, purpose.notes)),
        video=purpose.video,
        video_frames=purpose.video_frames,
        uncorrected=None if purpose.uncorrected is None else purpose.uncorrected.model_dump(mode="json"),
        words=None if purpose.words is None else tuple(map(as_unicode, purpose.words)),
        sequences=tuple(SequenceSubject(leaves=_plain(leaves), fps=fps) for leaves, fps in sequences),
        **this_process(),
    )


def _plain(leaves: SequenceLeaves | TrajectoryLeaves) -> dict:
    """Return the fields as JSON has them."""
    fields = leaves._asdict() | {"name": as_unicode(leaves.name)}
    return {name: _as_json(value) for name, value in fields.items()}


def _as_json(value: object) -> object:
    if isinstance(value, tuple):
        return list(map(_as_json, value))
    if isinstance(value, Frozen):
        return value.model_dump(mode="json")
    if isinstance(value, LeavesByName):
        return value.recorded()
    return dict(value) if isinstance(value, Mapping) else value
