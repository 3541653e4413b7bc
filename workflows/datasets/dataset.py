"""What a data set is: a layout on disk, the sequences chosen from it, and how each is read."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

from moseg.schemas.errors import InputError
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
    """Where the content of one sequence comes from.

    Attributes
    ----------
    name : str
    frames : FrameSource
    annotations : MaskSource or None
        Ground truth of the annotated frames at the frames' original size; 0 is static, other labels move.
    void : int or None
        Annotated label that counts for neither side.
    num_motions : int or None
        True number of motions, the background's included; None where it must be counted in the annotations.
    labelled_points : LabelledPointFile or None
        Ground truth at points, where there are no annotations.
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
    """Where the content of a clip without images comes from: its trajectories and their labels."""

    name: str
    trajectories: "TrajectoryFile"
    labels: "TrajectoryLabels"


class DatasetLayout(Protocol):
    """How the files of a data set lie below its root.

    Attributes
    ----------
    name : str
    needs_root : bool
        False for what is rendered.
    official : tuple of str, or None
        Sequences of the published benchmark; None: those of the list file, or all that are on disk.
    list_name : str or None
        File below the root that lists the sequences where `official` cannot.
    ground_truth, tree, source : str
        What is annotated, the expected files below the root, and where to get them: one line each.
    """

    name: str
    needs_root: bool
    official: tuple[str, ...] | None
    list_name: str | None
    ground_truth: str
    tree: str
    source: str

    def on_disk(self, root: str | None) -> tuple[str, ...]:
        """Names of the sequences whose frames, or trajectories, are below the root."""


@runtime_checkable
class FrameLayout(DatasetLayout, Protocol):
    """A data set of frames."""

    def open_sequence(self, root: str | None, name: str, max_side: int) -> SequenceSource:
        """The sources of one sequence; raises InputError where its files are not as expected."""


@runtime_checkable
class TrajectoryLayout(DatasetLayout, Protocol):
    """A data set of labelled trajectories, without frames."""

    def open_trajectories(self, root: str | None, name: str) -> TrajectorySource:
        """The sources of one clip."""


@dataclass(frozen=True)
class Dataset:
    """Sequences chosen from a data set.

    Attributes
    ----------
    layout : DatasetLayout
    root : str or None
    names : tuple of str
        Sequences that were asked for and are on disk.
    absent : tuple of str
        Sequences that were asked for, by name or by being in the official list, and are not on disk.
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
        """Name of the data set."""
        return self.layout.name

    @property
    def has_frames(self) -> bool:
        """False for labelled trajectories alone."""
        return isinstance(self.layout, FrameLayout)

    def sequence(self, name: str) -> SequenceSource:
        """The sources of one of `names`; raises InputError on another name or where files are not as expected, and
        where the data set has no frames."""
        self._check_name(name)
        if not isinstance(self.layout, FrameLayout):
            expected = "a data set of frames; trajectories run by moseg eval, ablate and plan"
            raise InputError("no frames", where=f"data set {self.name}", got="labelled trajectories", expected=expected)
        return self.layout.open_sequence(self.root, name, self.max_side)

    def trajectories(self, name: str) -> TrajectorySource:
        """The sources of one of `names`; raises InputError on another name, and where the data set has frames."""
        self._check_name(name)
        if not isinstance(self.layout, TrajectoryLayout):
            raise InputError("no labelled trajectories", where=f"data set {self.name}", expected="kt3dmoseg")
        return self.layout.open_trajectories(self.root, name)

    def _check_name(self, name: str) -> None:
        if name not in self.names:
            raise unknown_name(f"sequence of {self.name}", name, self.names)
