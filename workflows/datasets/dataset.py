"""Data sets: a layout on disk, the sequences chosen from it, and their sources."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

from moseg.schemas.errors import InputError
from moseg.schemas.scores import GroundTruth
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
    objects : MaskSource or None
        All prominent objects, static ones included.
    objects_void : int or None
        Label of `objects` that is no object.
    depth, flow_forward, flow_backward, tracks : source or None
        Given cues.
    """

    name: str
    frames: "FrameSource"
    annotations: "MaskSource | None" = None
    void: int | None = None
    num_motions: int | None = None
    labelled_points: "LabelledPointFile | None" = None
    objects: "MaskSource | None" = None
    objects_void: int | None = None
    depth: "SceneDepth | DepthFiles | None" = None
    flow_forward: "SceneFlow | FlowFiles | None" = None
    flow_backward: "SceneFlow | FlowFiles | None" = None
    tracks: "SceneTracks | TrackFile | None" = None


class TrajectorySource(NamedTuple):
    """Sources of a clip without images: its trajectories and their labels."""

    name: str
    trajectories: "TrajectoryFile"
    labels: "TrajectoryLabels"


class DatasetLayout(Protocol):
    """Layout of the files of a data set below its root.

    Attributes
    ----------
    name : str
    needs_root : bool
        False for rendered sequences.
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
        Sequences requested by name or by the official list that are not on disk.
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
            raise InputError("no labelled trajectories", where=f"data set {self.name}", expected="kt3dmoseg")
        return self.layout.open_trajectories(self.root, name)

    def _check_name(self, name: str) -> None:
        if name not in self.names:
            raise unknown_name(f"sequence of {self.name}", name, self.names)


def find_ground_truth(sources: Sequence[SequenceSource]) -> GroundTruth:
    """Return 'pixels' if every sequence has annotated masks, 'points' if every one has labelled points instead.

    Raises
    ------
    InputError
        A sequence without ground truth; or sequences of both kinds, whose scores have no common mean.
    """
    over = {source.name: _kind(source) for source in sources}
    points = [name for name, kind in over.items() if kind == "points"]
    if points and len(points) < len(over):
        masks = [name for name, kind in over.items() if kind == "pixels"]
        raise InputError(
            "ground truth of two kinds, which have no common mean",
            got=f"masks for {', '.join(masks)} and only labelled points for {', '.join(points)}",
            expected="sequences of one kind (--sequences)",
        )
    return "points" if points else "pixels"


def _kind(source: SequenceSource) -> GroundTruth:
    if source.annotations is not None:
        return "pixels"
    if source.labelled_points is not None:
        return "points"
    raise InputError("no ground truth to score against", where=f"sequence {source.name}")
