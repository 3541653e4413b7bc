"""The stored run whose results lie in a folder, also after they were corrected."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.corrections import Corrections, Edit, Growing, kind_of
from moseg.schemas.errors import InputError, MissingArtifactError
from moseg.store import ArtifactStore
from moseg.workflows.api.given_corrections import CORRECTIONS
from moseg.workflows.config.corrections_file import read_corrections
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.exports.motion_json import SequenceSummary
from moseg.workflows.exports.outputs import MASKS, mask_name
from moseg.workflows.graph import SequenceGraph, make_graph
from moseg.workflows.pipelines.placed_edits import WITH_PIXELS
from moseg.workflows.results.shown_frames import spread
from moseg.workflows.sources.files import read_bytes
from moseg.workflows.sources.mask_files import decode_mask
from moseg.workflows.sources.resize import resize_labels
from moseg.workflows.stages.registry import find_task
from moseg.workflows.view.stored_runs import StoredRun, readable_runs

COMPARED_FRAMES = 5
"""Frames, spread over the video, whose masks tell whether a folder has the results of a run."""


def find_run_of(store: ArtifactStore, folder: Path, summary: SequenceSummary) -> StoredRun:
    """Return the latest run whose results a folder has.

    It is the run that gives the folder's masks: as it ran, or under the folder's corrections, all or the first of them,
    because masks may have been written before the last ones. Masks of corrections that were taken back since are those
    of no run; they are attributed to one only if all runs on these frames have the same settings.

    Raises
    ------
    InputError
        The store has no such run, or the folder's masks or corrections cannot be read.
    """
    file = folder / CORRECTIONS
    corrections = read_corrections(str(file)) if file.exists() else None
    runs = [run for run in readable_runs(store) if _may_be_of(run, summary)]
    saved: dict[int, np.ndarray] = {}
    for frame in spread(summary.num_frames, COMPARED_FRAMES):
        path = str(folder / MASKS / mask_name(frame))
        saved[frame] = decode_mask(read_bytes(path), path, "instance")
    for run in runs:
        if any(_gives_masks(store, graph, run, saved) for graph in _graphs_of(run, summary, corrections)):
            return run
    if corrections is not None and runs and all(_is_same_work(run, runs[0]) for run in runs):
        return runs[0]
    expected = "`moseg view VIDEO --out` with this folder, which computes what is missing; or the run's own --store"
    raise InputError("the results behind these masks are not stored", where=folder, got=store.url, expected=expected)


def _may_be_of(run: StoredRun, summary: SequenceSummary) -> bool:
    """Return whether a run is of these frames, as far as that is known of runs and folders of earlier versions."""
    if (run.leaves.name, len(run.leaves.frames)) != (summary.name, summary.num_frames):
        return False
    names = None if run.video_frames is None else run.video_frames.names
    known = (run.video, summary.video), (run.numbers, summary.numbers), (names, summary.frames)
    return all(None in pair or pair[0] == pair[1] for pair in known)


def _graphs_of(run: StoredRun, summary: SequenceSummary, corrections: Corrections | None) -> Iterator[SequenceGraph]:
    """Yield the graphs of a run as it ran, and with the corrections of a folder, all or the first of them."""
    yield make_graph(run.leaves, run.config)
    if corrections is None:
        return
    for settings in (corrections.settings, {}) if corrections.settings else ({},):
        try:
            config = replace(PipelineChoices(run.uncorrected), corrected=settings).make_config()
        except InputError:
            # Not a setting of this run's plug-ins: the masks were not made with it.
            continue
        for count in range(len(corrections.edits), -1, -1):
            if not _can_draw(run, config, corrections.edits[:count]):
                continue
            size = run.leaves.frame_size or (summary.height, summary.width)
            yield make_graph(run.leaves._replace(edits=corrections.edits[:count], frame_size=size), config)


def _can_draw(run: StoredRun, config: PipelineConfig, edits: tuple[Edit, ...]) -> bool:
    """Return whether a run has the frames in which edits draw, and the weights of the network that grows objects."""
    drawn = [getattr(edit, kind_of(edit)) for edit in edits if kind_of(edit) in WITH_PIXELS]
    has_network = find_task("grown_object", "sam2").network.item(config) in run.leaves.weights
    return all(
        value.frame < len(run.leaves.frames) and (has_network or not isinstance(value, Growing) or value.by != "sam2")
        for value in drawn
    )


def _gives_masks(store: ArtifactStore, graph: SequenceGraph, run: StoredRun, saved: dict[int, np.ndarray]) -> bool:
    """Return whether the labels of a graph are stored and equal masks, uint16 (y, x), by frame."""
    refs = graph.segmentations(run.variant)
    try:
        for frame, mask in saved.items():
            section, row = graph.place(frame)
            labels = store.read_rows(refs[section], "labels", row, row + 1)[0]
            if not np.array_equal(resize_labels(labels, mask.shape), mask):
                return False
    except MissingArtifactError:
        return False
    return True


def _is_same_work(run: StoredRun, other: StoredRun) -> bool:
    """Return whether two runs differ in nothing but corrections and what these need."""
    works = [
        (each.leaves._replace(edits=(), frame_size=None, weights={}), each.uncorrected, each.variant)
        for each in (run, other)
    ]
    return works[0] == works[1]
