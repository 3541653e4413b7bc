"""What a report shows: its sequences and what every variant made of them, gathered and not yet laid out."""

from typing import NamedTuple

from moseg.workflows.reports.figure_content import EigenvaluePlot, Matrix
from moseg.workflows.reports.picture_content import Layer, Video
from moseg.workflows.reports.table_content import ObjectRow, ParameterRow, ScoreTable, StageRow


class GroupedObject(NamedTuple):
    """An object as a variant groups it.

    Attributes
    ----------
    name : str
        ``background``, or its identity with what a network called it.
    motion : int
        Its motion group; 0 = static, with the background.
    colour : str or None
        Of its outline in the overlay, ``#rrggbb``; None where it is not outlined.
    """

    name: str
    motion: int
    colour: str | None = None


class VariantPanel(NamedTuple):
    """What one variant made of a sequence.

    Attributes
    ----------
    variant : str
    objects : tuple of GroupedObject
        The background, then the objects by identity; empty where no object is grouped.
    matrices : tuple of Matrix
        Residuals and affinity of each of its motion models, then what it fused.
    eigenvalues : EigenvaluePlot or None
    missing : tuple of str
        What could not be shown and why, one sentence each.
    """

    variant: str
    objects: tuple[GroupedObject, ...]
    matrices: tuple[Matrix, ...] = ()
    eigenvalues: EigenvaluePlot | None = None
    missing: tuple[str, ...] = ()


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
