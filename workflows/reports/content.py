"""Content of a report: tables, figures and pictures of a run's sequences, gathered and not yet laid out."""

from enum import StrEnum
from typing import NamedTuple

import numpy as np

from moseg.schemas.scores import GroundTruth
from moseg.workflows.results.mask_history import MaskChange


class Better(StrEnum):
    """Which of two figures is the better one."""

    MORE = "more"
    LESS = "less"


class ScoreTable(NamedTuple):
    """A head, and rows of a name and percentages; None is an empty cell.

    Attributes
    ----------
    columns : tuple of str
        The first one names the rows.
    is_published : bool
        Whether a paper reports these figures, which are not measured here.
    better : tuple of Better or None
        Which values are better in each column of figures, None where neither is (a count); empty: more, in all columns.
    decimals : tuple of int
        Digits after the point in each column of figures; empty: one in all columns.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[float | None, ...]], ...]
    is_published: bool = False
    over: GroundTruth | None = None
    better: tuple[Better | None, ...] = ()
    decimals: tuple[int, ...] = ()


class ObjectRow(NamedTuple):
    """One moving object: its colour in the overlay (``#rrggbb``), when it is seen and moves, and how large it is.

    `num_moving` is the number of frames in which it moves now, `sure_percent` and `complete_percent` are the expected
    precision and recall of its masks; None where that is not known.
    """

    identity: int
    colour: str
    motion: int
    first_frame: int
    last_frame: int
    num_frames: int
    mean_area_percent: float
    tag: str | None = None
    num_moving: int | None = None
    sure_percent: float | None = None
    complete_percent: float | None = None


class StageRow(NamedTuple):
    """Artifacts of one stage that the run computed and reused, and the seconds inside the stage's functions."""

    stage: str
    computed: int
    reused: int
    seconds: float


class ParameterRow(NamedTuple):
    """A parameter that differs from its default; texts as a user writes them."""

    name: str
    value: str
    default: str
    description: str


class Matrix(NamedTuple):
    """A square matrix over the objects of a sequence, or over a sample of its tracks.

    Attributes
    ----------
    values : float64 (k, k)
        NaN where there is no value.
    labels : tuple of str
        Of rows and columns: ``background``, then identities. Empty where there are too many to name.
    unit : str
        Empty for a pure number.
    description : str
        One sentence: what rows and columns are, and what a large value means.
    is_log : bool
        Whether colours follow the logarithm: residuals span decades.
    """

    title: str
    values: np.ndarray
    labels: tuple[str, ...]
    unit: str = ""
    description: str = ""
    is_log: bool = False


class EigenvaluePlot(NamedTuple):
    """The eigenvalues behind the number of motions.

    Attributes
    ----------
    eigenvalues : float64 (n,) or (V, n)
        Of the normalised affinity that was clustered, in the order in which they were used; one row for each view where
        the views were not fused into one kernel.
    num_motions : int
        Chosen number, the background's included.
    how : str
        One sentence: how the number was chosen.
    """

    eigenvalues: np.ndarray
    num_motions: int
    how: str


class Picture(NamedTuple):
    """An encoded picture of a media type such as ``image/webp``; width and height in px."""

    media_type: str
    data: bytes
    width: int
    height: int


class Video(NamedTuple):
    """An encoded video of a sequence, H.264 in MP4; width and height in px.

    Attributes
    ----------
    fps : float
        Frames of the video per second.
    step : int
        It holds every `step`-th frame of the sequence, from the first one on.
    """

    data: bytes
    width: int
    height: int
    fps: float
    step: int = 1


class MaskArchive(NamedTuple):
    """Masks of a sequence's moving objects, one PNG a frame, as analysed.

    Attributes
    ----------
    data : bytes
        A ZIP archive of files that are not compressed again.
    places : tuple of (int, int, int)
        Frame, and first byte and size of its PNG within `data`.
    """

    data: bytes
    places: tuple[tuple[int, int, int], ...]


class Thumbnail(NamedTuple):
    """An object cut out of a frame."""

    frame: int
    picture: Picture


class ObjectTimeline(NamedTuple):
    """One moving object over the frames of a sequence.

    Attributes
    ----------
    name : str
        Its identity, and the name that a network gave it.
    colour : str
        Of its outline in the overlay, ``#rrggbb``.
    areas : tuple of float
        Percent of the frame, of every `step`-th frame; 0 where it is not seen.
    step : int
    changes : tuple of MaskChange
        Frames at which its mask shrinks, splits or vanishes, in order.
    thumbnails : tuple of Thumbnail or None
        One for each of equal stretches of the sequence; None where it is not seen in the stretch.
    moving_frames : tuple of (int, int) or None
        First and last frame of each run of frames in which it moves now; None where that is not known.
    """

    name: str
    colour: str
    areas: tuple[float, ...]
    step: int
    changes: tuple[MaskChange, ...] = ()
    thumbnails: tuple[Thumbnail | None, ...] = ()
    moving_frames: tuple[tuple[int, int], ...] | None = None


class LayerKind(StrEnum):
    """How a layer is shown."""

    BASE = "base"
    """An opaque picture, one at a time: the frame, flow, saliency, inverse depth."""
    OVER = "over"
    """Transparent where nothing is drawn; several lie over the base: masks, ground truth, errors, tracks."""


class LegendEntry(NamedTuple):
    """A colour, ``#rrggbb``, and its meaning."""

    colour: str
    meaning: str


class Layer(NamedTuple):
    """One picture for each frame that a sequence shows.

    Attributes
    ----------
    name : str
        Unique in its sequence, for instance ``moving objects (fused)``.
    pictures : tuple of Picture or None
        One for each of the sequence's `frames`; None where the frame has none (no annotation, last frame's flow).
    key : Picture or None
        A colour key that is no list: the wheel of flow directions, a colour bar.
    description : str
        One sentence: what is drawn, with its unit.
    is_shown : bool
        Whether the page shows it at first.
    is_beside : bool
        Whether it belongs to the second picture: the first such layer is shown there at first.
    """

    name: str
    kind: LayerKind
    pictures: tuple[Picture | None, ...]
    legend: tuple[LegendEntry, ...] = ()
    key: Picture | None = None
    description: str = ""
    is_shown: bool = False
    is_beside: bool = False


class GroupedObject(NamedTuple):
    """An object as a variant groups it.

    Attributes
    ----------
    name : str
        ``background``, or its identity and the name that a network gave it.
    motion : int
        Its motion group; 0 = static, with the background.
    colour : str or None
        Of its outline in the overlay, ``#rrggbb``; None where it has no outline.
    reason : str
        Why a rigid scene decided that it is static or moves; empty where it did not decide.
    """

    name: str
    motion: int
    colour: str | None = None
    reason: str = ""


class VariantPanel(NamedTuple):
    """What one variant found in a sequence.

    Attributes
    ----------
    objects : tuple of GroupedObject
        The background, then the objects by identity; empty where no object is grouped.
    scene : str
        The frames of the scene that these are the objects of, in words; empty where there is a single scene.
    matrices : tuple of Matrix
        Residuals and affinity of each of its motion models, then the fused kernel.
    missing : tuple of str
        What could not be shown and why, one sentence each.
    """

    variant: str
    objects: tuple[GroupedObject, ...]
    matrices: tuple[Matrix, ...] = ()
    eigenvalues: EigenvaluePlot | None = None
    missing: tuple[str, ...] = ()
    scene: str = ""

    @property
    def title(self) -> str:
        """The variant, and the scene where there are several."""
        return f"{self.variant}, {self.scene}" if self.scene else self.variant


class SequencePanel(NamedTuple):
    """One sequence.

    Attributes
    ----------
    num_frames : int
        Of the whole sequence.
    shape : (int, int)
        Height and width of the frames as analysed, px.
    frames : tuple of int
        Frames that its layers show, counted from 0.
    objects : tuple of ObjectRow
        Of the first variant.
    video : Video or None
        Overlay of the first variant.
    timelines : tuple of ObjectTimeline
        Of the largest objects of the first variant, largest first.
    masks : MaskArchive or None
        Of the first variant.
    missing : tuple of str
        What could not be shown and why, one sentence each.
    """

    name: str
    num_frames: int
    shape: tuple[int, int]
    frames: tuple[int, ...]
    layers: tuple[Layer, ...]
    objects: tuple[ObjectRow, ...] = ()
    variants: tuple[VariantPanel, ...] = ()
    video: Video | None = None
    missing: tuple[str, ...] = ()
    timelines: tuple[ObjectTimeline, ...] = ()
    masks: MaskArchive | None = None


class ReportPage(NamedTuple):
    """One run.

    Attributes
    ----------
    title : str
        For instance ``davis16: fused, oc``.
    facts : tuple of (str, str)
        Name and value: command, run, began, took, version, host, workers.
    notes : tuple of str
        What a reader must know to read the figures correctly.
    """

    title: str
    facts: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]
    scores: tuple[ScoreTable, ...]
    sequences: tuple[SequencePanel, ...]
    stages: tuple[StageRow, ...]
    parameters: tuple[ParameterRow, ...]
