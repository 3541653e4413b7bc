"""What a report shows: pictures, matrices, plots and tables, gathered from a store and not yet laid out."""

from enum import StrEnum
from typing import NamedTuple

import numpy as np

from schemas.scores import GroundTruth


class Picture(NamedTuple):
    """An encoded picture, as a page embeds it.

    Attributes
    ----------
    media_type : str
        ``image/webp``, ``image/png`` or ``image/jpeg``.
    data : bytes
    width, height : int
        Px.
    """

    media_type: str
    data: bytes
    width: int
    height: int


class Video(NamedTuple):
    """An encoded video of every frame of a sequence; H.264 in MP4."""

    data: bytes
    width: int
    height: int
    fps: float


class LayerKind(StrEnum):
    """How a layer is shown."""

    BASE = "base"
    """An opaque picture, one at a time: the frame, flow, saliency, inverse depth."""
    OVER = "over"
    """Transparent where it says nothing, so that several lie over the base: masks, ground truth, errors, tracks."""


class LegendEntry(NamedTuple):
    """A colour and what it means; colours are ``#rrggbb``."""

    colour: str
    meaning: str


class Layer(NamedTuple):
    """One picture for each frame that a sequence shows.

    Attributes
    ----------
    name : str
        Unique in its sequence, for instance ``moving objects (fused)``.
    kind : LayerKind
    pictures : tuple of Picture or None
        One for each of the sequence's `frames`; None where the frame has none (no annotation, last frame's flow).
    legend : tuple of LegendEntry
    key : Picture or None
        A colour key that no list can give: the wheel of flow directions, a colour bar.
    description : str
        One sentence: what is drawn, with its unit.
    is_shown : bool
        Whether the page shows it at first.
    """

    name: str
    kind: LayerKind
    pictures: tuple[Picture | None, ...]
    legend: tuple[LegendEntry, ...] = ()
    key: Picture | None = None
    description: str = ""
    is_shown: bool = False


class Matrix(NamedTuple):
    """A square matrix over the objects of a sequence, or over a sample of its tracks.

    Attributes
    ----------
    title : str
        For instance ``residuals, trajs``.
    values : float64 (k, k)
        NaN where there is none.
    labels : tuple of str
        Of rows and columns alike: ``background``, then identities. Empty where there are too many to name.
    unit : str
        Empty for a pure number.
    description : str
        One sentence: what row and column are, and what a large value means.
    is_log : bool
        Whether colours go by the logarithm: residuals span decades.
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
    eigenvalues : float64 (n,)
        Of the normalised affinity that the groups were cut from, in the order in which they were used.
    num_motions : int
        Chosen, the background's included.
    how : str
        One sentence: how the number was chosen, with the threshold where there is one.
    threshold : float or None
        Drawn as a line where the choice compares eigenvalues with it.
    """

    eigenvalues: np.ndarray
    num_motions: int
    how: str
    threshold: float | None = None


class VariantPanel(NamedTuple):
    """What one variant made of a sequence.

    Attributes
    ----------
    variant : str
    motions : dict of str to int
        Motion group by object (``background``, then identities); 0 = static, with the background.
    matrices : tuple of Matrix
        Residuals and affinity of each of its motion models, then what it fused.
    eigenvalues : EigenvaluePlot or None
    missing : tuple of str
        What could not be shown and why, one sentence each.
    """

    variant: str
    motions: dict[str, int]
    matrices: tuple[Matrix, ...] = ()
    eigenvalues: EigenvaluePlot | None = None
    missing: tuple[str, ...] = ()


class ObjectRow(NamedTuple):
    """One moving object: its colour in the overlay (``#rrggbb``), when it is seen and how large it is."""

    identity: int
    colour: str
    motion: int
    first_frame: int
    last_frame: int
    num_frames: int
    mean_area_percent: float
    tag: str | None = None


class SequencePanel(NamedTuple):
    """One sequence.

    Attributes
    ----------
    name : str
    num_frames : int
        Of the whole sequence.
    shape : (int, int)
        Height and width of the frames as analysed, px.
    frames : tuple of int
        Those that its layers show, counted from 0.
    layers : tuple of Layer
    objects : tuple of ObjectRow
        Of the first variant.
    variants : tuple of VariantPanel
    video : Video or None
        Overlay of the first variant.
    missing : tuple of str
        What could not be shown and why, one sentence each.
    """

    name: str
    num_frames: int
    shape: tuple[int, int]
    frames: tuple[int, ...]
    layers: tuple[Layer, ...]
    objects: tuple[ObjectRow, ...]
    variants: tuple[VariantPanel, ...]
    video: Video | None = None
    missing: tuple[str, ...] = ()


class ScoreTable(NamedTuple):
    """Scores: a head and rows of a name and percentages; None is an empty cell.

    Attributes
    ----------
    title : str
    columns : tuple of str
        The first one names the rows.
    rows : tuple of (str, tuple of float or None)
    is_published : bool
        Whether these are figures that a paper reports, which nobody measured here.
    over : 'pixels', 'points' or None
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[float | None, ...]], ...]
    is_published: bool = False
    over: GroundTruth | None = None


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


class ReportPage(NamedTuple):
    """One run.

    Attributes
    ----------
    title : str
        For instance ``davis16: fused, oc``.
    facts : tuple of (str, str)
        Name and value: command, run, began, took, version, host, workers.
    notes : tuple of str
        What a reader must know to read the figures rightly.
    scores : tuple of ScoreTable
    sequences : tuple of SequencePanel
    stages : tuple of StageRow
    parameters : tuple of ParameterRow
    """

    title: str
    facts: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]
    scores: tuple[ScoreTable, ...]
    sequences: tuple[SequencePanel, ...]
    stages: tuple[StageRow, ...]
    parameters: tuple[ParameterRow, ...]
