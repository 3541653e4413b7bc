"""Data sets: a layout on disk, the sequences chosen from it, and their sources."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

from moseg.schemas.errors import InputError
from moseg.schemas.scores import GroundTruth
from moseg.schemas.sequence_groups import SequenceGroup
from moseg.schemas.spelling import unknown_name

if TYPE_CHECKING:
    from moseg.workflows.sources import (
        DepthFiles,
        FlowFiles,
        FrameSource,
        LabelledPointFile,
        MaskSource,
        SceneDepth,
        SceneFlow,
        SceneTracks,
        TrackFile,
        TrajectoryFile,
        TrajectoryLabels,
    )


class SequenceSource(NamedTuple):
    """Sources of the content of one sequence.

    Attributes
    ----------
    name : str
    frames : FrameSource
    annotations : MaskSource or None
        Ground truth of the annotated frames at the frames' original size; 0 is static, other labels move.
    void : int or None
        Annotated label that counts for neither side.
    num_motions : int or None
        True number of motions, the background's included; None if it must be counted in the annotations.
    labelled_points : LabelledPointFile or None
        Ground truth at points, if there are no annotations.
    nothing_moves : bool
        Whether nothing moves in the sequence, which needs no other ground truth.
    objects : MaskSource or None
        All prominent objects, static ones included.
    objects_void : int or None
        Label of `objects` that is no object.
    depth, flow_forward, flow_backward, tracks : source or None
        Given cues.
    notes : tuple of str
        What must be known about the frames to read a result rightly.
    """

    name: str
    frames: "FrameSource"
    annotations: "MaskSource | None" = None
    void: int | None = None
    num_motions: int | None = None
    labelled_points: "LabelledPointFile | None" = None
    nothing_moves: bool = False
    objects: "MaskSource | None" = None
    objects_void: int | None = None
    depth: "SceneDepth | DepthFiles | None" = None
    flow_forward: "SceneFlow | FlowFiles | None" = None
    flow_backward: "SceneFlow | FlowFiles | None" = None
    tracks: "SceneTracks | TrackFile | None" = None
    notes: tuple[str, ...] = ()


class TrajectorySource(NamedTuple):
    """Sources of a clip without images: its trajectories, their labels, and the groups that papers count it in."""

    name: str
    trajectories: "TrajectoryFile"
    labels: "TrajectoryLabels"
    groups: tuple[SequenceGroup, ...] = ()


class DatasetLayout(Protocol):
    """Layout of the files of a data set below its root.

    Attributes
    ----------
    name : str
    needs_root : bool
        False for rendered sequences; see also `OptionalRoot`.
    official : tuple of str, or None
        Sequences of the published benchmark; None for those of the list file, or all that are on disk.
    list_name : str or None
        File below the root that lists the sequences if `official` is None.
    ground_truth, tree, source : str
        What is annotated, the expected files below the root, and where to get them, in one line each.
    """

    name: str
    needs_root: bool
    official: tuple[str, ...] | None
    list_name: str | None
    ground_truth: str
    tree: str
    source: str

    def on_disk(self, root: str | None) -> tuple[str, ...]:
        """Return the names of the sequences whose frames, or trajectories, are below the root."""


@runtime_checkable
class FrameLayout(DatasetLayout, Protocol):
    """A data set of frames."""

    def open_sequence(self, root: str | None, name: str, max_side: int) -> SequenceSource:
        """Return the sources of one sequence; raise InputError if its files are not as expected."""


@runtime_checkable
class OptionalRoot(Protocol):
    """A data set that has sequences without a root, and more with one; its `needs_root` is False."""

    def missing(self, root: str | None) -> tuple[str, ...]:
        """Return what the data set would have besides, in the words of "... is not on disk"."""


@runtime_checkable
class TrajectoryLayout(DatasetLayout, Protocol):
    """A data set of labelled trajectories, without frames."""

    def open_trajectories(self, root: str | None, name: str) -> TrajectorySource:
        """Return the sources of one clip."""


@dataclass(frozen=True)
class Dataset:
    """Sequences chosen from a data set.

    Attributes
    ----------
    layout : DatasetLayout
    root : str or None
    names : tuple of str
        Requested sequences that are on disk.
    absent : tuple of str
        Sequences requested by name or by the official list that are not on disk; of a data set whose root is optional,
        what is not below it.
    max_side : int
        Frames whose longer side exceeds it are area-resized to it, px.
    """

    layout: DatasetLayout
    root: str | None
    names: tuple[str, ...]
    absent: tuple[str, ...]
    max_side: int

    @property
    def name(self) -> str:
        """Return the name of the data set."""
        return self.layout.name

    @property
    def has_frames(self) -> bool:
        """Return False for a data set of labelled trajectories only."""
        return isinstance(self.layout, FrameLayout)

    def sequence(self, name: str) -> SequenceSource:
        """Return the sources of one of `names`.

        Raises InputError for another name, files that are not as expected, or a data set without frames.
        """
        self._check_name(name)
        if not isinstance(self.layout, FrameLayout):
            expected = "a data set of frames; trajectories run by moseg eval, ablate and plan"
            raise InputError("no frames", where=f"data set {self.name}", got="labelled trajectories", expected=expected)
        return self.layout.open_sequence(self.root, name, self.max_side)

    def trajectories(self, name: str) -> TrajectorySource:
        """Return the sources of one of `names`; raise InputError for another name or a data set of frames."""
        self._check_name(name)
        if not isinstance(self.layout, TrajectoryLayout):
            expected = "a data set of labelled trajectories"
            raise InputError("no labelled trajectories", where=f"data set {self.name}", expected=expected)
        return self.layout.open_trajectories(self.root, name)

    def _check_name(self, name: str) -> None:
        if name not in self.names:
            raise unknown_name(f"sequence of {self.name}", name, self.names)


def find_ground_truth(sources: Sequence[SequenceSource]) -> GroundTruth:
    """Return the kind of ground truth that every sequence has.

    It is 'pixels' if they have annotated masks, 'points' if they have labelled points instead, and 'still' if nothing
    moves in them.

    Raises
    ------
    InputError
        A sequence without ground truth; or sequences of several kinds, whose scores have no common mean.
    """
    by_kind: dict[GroundTruth, list[str]] = {}
    for source in sources:
        by_kind.setdefault(_kind(source), []).append(source.name)
    if len(by_kind) > 1:
        raise InputError(
            f"ground truth of {'two' if len(by_kind) == 2 else 'three'} kinds, which have no common mean",
            got=" and ".join(f"{_KINDS[kind]} {', '.join(by_kind[kind])}" for kind in _KINDS if kind in by_kind),
            expected="sequences of one kind (--sequences)",
        )
    return next(iter(by_kind))


_KINDS: dict[GroundTruth, str] = {
    "pixels": "masks for",
    "points": "only labelled points for",
    "still": "no motion in",
}


def _kind(source: SequenceSource) -> GroundTruth:
    if source.annotations is not None:
        return "pixels"
    if source.labelled_points is not None:
        return "points"
    if source.nothing_moves:
        return "still"
    raise InputError("no ground truth to score against", where=f"sequence {source.name}")
