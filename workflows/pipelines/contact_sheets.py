"""Contact sheets: what the pipeline found in a few frames of every sequence, at a glance."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.tasks.metrics import Overlaps, count_overlaps, count_point_overlaps, region_similarity
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import Session
from moseg.workflows.engine.waves import in_waves
from moseg.workflows.exports.draw_contact_sheet import SheetFrame, draw_contact_sheet
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.pipelines.leaves import ingest_sequences
from moseg.workflows.process.atomic_write import atomic_path, blame_output
from moseg.workflows.results.shown_frames import (
    annotated_frames,
    label_points,
    read_labelled_points,
    scored_frames,
    spread,
)
from moseg.workflows.sources.resize import resize_labels


class SoftMap(NamedTuple):
    """Where a frame's soft map lies, as the reference and the name of an array, and what it is called."""

    ref: str
    array: str
    title: str


class _Sheet(NamedTuple):
    """One sheet: the graph of its sequence, the frames shown, and the references of what is drawn."""

    graph: SequenceGraph
    frames: tuple[int, ...]
    segmentations: tuple[str, ...]
    soft_maps: tuple[SoftMap, ...] | None
    score: str | None


def write_contact_sheets(
    session: Session,
    sources: Sequence[SequenceSource],
    config: PipelineConfig,
    variant: Variant,
    folder: Path,
    num_frames: int,
) -> tuple[Path, ...]:
    """Write ``<sequence>.png`` for every sequence, computing no more than an evaluation of the variant would.

    Parameters
    ----------
    folder : Path
        Created where it is absent; other files in it are left alone.
    num_frames : int
        Frames of a sheet, spread evenly over the annotated ones, over all where there is no ground truth; all of them
        where there are fewer.

    Returns
    -------
    tuple of Path
        The sheets, in the order of `sources`.

    Raises
    ------
    InputError
        A sequence cannot be read or lacks a cue that `config` takes as given, or the folder cannot be written.
    """
    waves = in_waves(session, sources)
    return tuple(path for wave in waves for path in _write_sheets(session, wave, config, variant, folder, num_frames))


def _write_sheets(
    session: Session,
    sources: Sequence[SequenceSource],
    config: PipelineConfig,
    variant: Variant,
    folder: Path,
    num_frames: int,
) -> tuple[Path, ...]:
    """Write the sheets of the sequences of a wave."""
    sheets: list[_Sheet] = []

    def build():
        recipes, sinks = {}, []
        sheets.clear()
        for leaves in ingest_sequences(session, sources, config, annotated=True):
            sheet = _plan_sheet(session.store, SequenceGraph(leaves, config), config, variant, num_frames)
            sheets.append(sheet)
            sinks += sheet.segmentations
            # They may be missing in the store although the artifacts made from them are there.
            sinks += [soft_map.ref for soft_map in sheet.soft_maps or ()]
            sinks += [sheet.score] if sheet.score else []
            recipes |= sheet.graph.recipes
        return recipes, sinks

    def read():
        return tuple(_write_sheet(session.store, sheet, config, variant, folder) for sheet in sheets)

    return session.compute(build, read)


def choose_soft_map(graph: SequenceGraph, frame: int) -> SoftMap | None:
    """Return the motion saliency of a frame; None where objects come from elsewhere."""
    if not graph.objects.uses_saliency:
        return None
    return SoftMap(graph.frame_cues.saliency(frame), "saliency", "saliency")


def _plan_sheet(
    store: ArtifactStore, graph: SequenceGraph, config: PipelineConfig, variant: Variant, num_frames: int
) -> _Sheet:
    shown = scored_frames(store, graph.leaves)
    frames = tuple(shown[position] for position in spread(len(shown), num_frames))
    soft_maps = tuple(choose_soft_map(graph, frame) for frame in frames)
    return _Sheet(
        graph=graph,
        frames=frames,
        segmentations=graph.segmentations(variant),
        soft_maps=None if None in soft_maps else soft_maps,
        score=graph.score(variant) if _is_scored(graph.leaves) else None,
    )


def _write_sheet(store: ArtifactStore, sheet: _Sheet, config: PipelineConfig, variant: Variant, folder: Path) -> Path:
    leaves = sheet.graph.leaves
    head = [f"{leaves.name}   {variant}"]
    if sheet.score is not None:
        head.append(_name_score(store.attributes(sheet.score), leaves))
    title = sheet.soft_maps[0].title if sheet.soft_maps else ""
    frames = _read_frames(store, sheet, config.sections.length)
    path = Path(folder) / f"{leaves.name}.png"
    image = Image.fromarray(draw_contact_sheet("   ".join(head), frames, title, leaves.void))
    with atomic_path(path) as temporary, blame_output(path):
        image.save(temporary, format="PNG")
    return path


def _is_scored(leaves: SequenceLeaves) -> bool:
    return leaves.annotation is not None or leaves.labelled_points is not None or leaves.nothing_moves


def _name_score(score: Mapping[str, float], leaves: SequenceLeaves) -> str:
    if leaves.nothing_moves:
        return f"false pixels {score['false_pixels']:.2f} %   false frames {score['false_frames']:.2f} %"
    return f"J {score['J']:.1f}   Fu {score['F']:.1f}" + "   over points" * (leaves.annotation is None)


def _read_frames(store: ArtifactStore, sheet: _Sheet, section_length: int) -> Iterator[SheetFrame]:
    leaves = sheet.graph.leaves
    points = None if leaves.labelled_points is None else read_labelled_points(store, leaves.labelled_points)
    for position, frame in enumerate(sheet.frames):
        section, row = divmod(frame, section_length)
        labels = store.read_rows(sheet.segmentations[section], "labels", row, row + 1)[0]
        drawn = SheetFrame(frame, store.read(leaves.frames[frame], "image"), labels)
        if sheet.soft_maps:
            soft_map = sheet.soft_maps[position]
            drawn = drawn._replace(soft_map=store.read(soft_map.ref, soft_map.array).astype(np.float32))
        if leaves.annotation is not None:
            row = annotated_frames(store, leaves.annotation).index(frame)
            truth = store.read_rows(leaves.annotation, "masks", row, row + 1)[0]
            overlaps = count_overlaps(resize_labels(labels, truth.shape), truth, leaves.void)
            drawn = drawn._replace(truth=truth, J=_frame_similarity(overlaps))
        elif points is not None:
            labelled = label_points(points, frame, labels)
            overlaps = count_point_overlaps(labelled.predicted, labelled.truth)
            drawn = drawn._replace(labelled=labelled, J=_frame_similarity(overlaps))
        yield drawn


def _frame_similarity(overlaps: Overlaps) -> float:
    """Return J of one frame, percent; overlaps are counted at the ground truth's size, as in the sequence's score."""
    true_labels = {true for true, _ in overlaps} - {0}
    predicted_labels = {predicted for _, predicted in overlaps} - {0}
    return 100 * region_similarity(overlaps, true_labels, predicted_labels)
