"""Evaluations as the command line and Python run them: from choices to a report."""

import os
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Literal, NamedTuple, TypeVar

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.schemas.errors import InputError, MissingStoreError
from moseg.schemas.scores import AnyReport, ScoredWith
from moseg.schemas.spelling import unknown_name
from moseg.schemas.trajectory_scores import TrajectoryReport
from moseg.schemas.weights import WeightsItem
from moseg.store import open_store
from moseg.workflows.api.arguments import Kind, check_kinds, read_names
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.config_files import changed_parameters
from moseg.workflows.config.notes import evaluation_notes, trajectory_notes
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.config.trajectory_choices import TrajectoryChoices
from moseg.workflows.datasets import DATASETS, Dataset, SequenceSource, list_trajectory_datasets, open_dataset
from moseg.workflows.datasets.given_folders import with_given_folders
from moseg.workflows.engine.session import StageUse
from moseg.workflows.exports import TextKind, check_replaceable, write_text
from moseg.workflows.pipelines.evaluate import evaluate
from moseg.workflows.pipelines.evaluate_trajectories import evaluate_trajectories
from moseg.workflows.pipelines.plan_evaluation import EmptyStore, plan_evaluation, plan_trajectories
from moseg.workflows.pipelines.purpose import Purpose
from moseg.workflows.plugins.loading import load_plugins
from moseg.workflows.reports.equal_rows import equality_notes
from moseg.workflows.reports.run_report import RunReport
from moseg.workflows.reports.score_tables import clip_tables, score_tables
from moseg.workflows.weights.folder import open_weights

AnyVariant = TypeVar("AnyVariant", Variant, TrajectoryVariant)
Report = AnyReport | TrajectoryReport


class DataChoice(NamedTuple):
    """Sequences of a data set; see `open_dataset`."""

    dataset: str
    root: str | None = None
    sequences: tuple[str, ...] | None = None
    list_file: str | None = None

    def open(self, max_side: int) -> Dataset:
        """Open the data set; raises InputError where it is not there or has no such sequence."""
        load_plugins()
        return open_dataset(self.dataset, self.root, self.sequences, self.list_file, max_side=max_side)


class Evaluated(NamedTuple):
    """A report, the use of the store by stage, and the line that names the page, where one was asked for."""

    report: Report
    stages: dict[str, StageUse]
    page: str | None


class Planned(NamedTuple):
    """Artifacts to compute and to reuse by stage, and the weights that must be fetched before.

    `num_open_choices` counts the stretches of video whose source of proposals is not chosen yet: what depends on them
    is counted as if it were saliency.
    """

    stages: dict[str, StageUse]
    missing_weights: tuple[WeightsItem, ...]
    num_open_choices: int = 0


def run_evaluation(
    command: Literal["eval", "ablate"],
    data: DataChoice,
    choices: PipelineChoices,
    trajectories: TrajectoryChoices,
    run: RunSettings,
    variants: Sequence[str] | None,
    json: str | None = None,
    page: str | None = None,
    option: str = "--motions",
) -> Evaluated:
    """Score variants on a data set of frames or of labelled trajectories.

    Parameters
    ----------
    variants : sequence of str or None
        All that the data set has where None.
    json, page : str or None
        Files to write the report to, as JSON and as a page.
    option : str
        What the number of motions is given by, for notes.

    Raises
    ------
    InputError
        A choice is wrong or has no meaning for the data set, a sequence cannot be read, or a file cannot be written.
    """
    config = choices.read()
    if json is not None:
        check_replaceable(json, TextKind.JSON)
        if page is not None and os.path.realpath(json) == os.path.realpath(page):
            raise InputError("scores and page in one file", where="--report", got=page, expected="another file")
    dataset = data.open(config.max_side)
    if dataset.has_frames:
        chosen, seeds = read_variants(variants, Variant, dataset.name), None
        trajectories.refuse(dataset.name, list_trajectory_datasets())
        sources = open_sequences(dataset, config, choices)
        absent = tuple(f"{name} is not on disk" for name in dataset.absent)
        notes = (*evaluation_notes(config, chosen, option), *absent)
    else:
        chosen, seeds = read_variants(variants, TrajectoryVariant, dataset.name), trajectories.all_seeds
        config = trajectories.apply(choices, config, dataset.name, chosen)
        sources = [dataset.trajectories(name) for name in dataset.names]
        notes = (_say_which_ran(dataset), *trajectory_notes(config, chosen, seeds))
    shown = None if page is None else RunReport(page, dataset.name, config, chosen, dataset.names, seeds)
    with run.open() as session:
        purpose, panels = Purpose(command, notes), None if shown is None else shown.panels
        if dataset.has_frames:
            report = evaluate(session, dataset.name, sources, config, chosen, purpose, panels)
        else:
            report = evaluate_trajectories(session, dataset.name, sources, config, chosen, seeds, purpose, panels)
        if shown is not None:
            shown.note_facts(session)
    if not isinstance(report, TrajectoryReport):
        notes = (*notes, *equality_notes({row.variant: row.sequences for row in report.rows}))
        report = report.model_copy(update={"notes": notes})
    settings = ScoredWith(version=version("moseg"), config=changed_parameters(config))
    report = report.model_copy(update={"settings": settings})
    if json is not None:
        write_report_json(json, report)
    if shown is None:
        return Evaluated(report, session.stages(), None)
    if dataset.has_frames:
        tables = score_tables(report.dataset, report.over, {row.variant: row.sequences for row in report.rows})
    else:
        tables = clip_tables(report.dataset, report.rows)
    return Evaluated(report, session.stages(), shown.write(tables, notes))


def run_plan(
    data: DataChoice,
    choices: PipelineChoices,
    trajectories: TrajectoryChoices,
    store: str,
    variants: Sequence[str] | None,
) -> Planned:
    """Find what an evaluation of the same choices would compute and reuse; nothing is computed or stored.

    Raises
    ------
    InputError
        As `run_evaluation`.
    """
    config = choices.read()
    dataset = data.open(config.max_side)
    try:
        opened = open_store(store, create=False)
    except MissingStoreError:
        opened = EmptyStore()
    weights = open_weights(os.environ, offline=True, check_licences=False)
    if dataset.has_frames:
        trajectories.refuse(dataset.name, list_trajectory_datasets())
        chosen = read_variants(variants, Variant, dataset.name)
        sources = open_sequences(dataset, config, choices)
        stages, read, num_open = plan_evaluation(opened, sources, config, chosen, weights)
    else:
        chosen = read_variants(variants, TrajectoryVariant, dataset.name)
        config = trajectories.apply(choices, config, dataset.name, chosen)
        sources = [dataset.trajectories(name) for name in dataset.names]
        stages, read, num_open = plan_trajectories(opened, sources, config, chosen, trajectories.all_seeds), (), 0
    items = [weights.item(name) for name in read]
    return Planned(stages, tuple(item for item in items if not weights.is_present(item)), num_open)


def _say_which_ran(dataset: Dataset) -> str:
    """Return how many clips of the official list an evaluation has, how many others, and which are missing."""
    official = dataset.layout.official
    if official is None:
        ran = f"{len(dataset.names)} clips ran"
    else:
        others = set(dataset.names).difference(official)
        ran = f"{len(dataset.names) - len(others)} of the {len(official)} clips ran"
        ran += f", and {len(others)} that are not of the data set" if others else ""
    return f"{ran}; not on disk: {', '.join(dataset.absent)}" if dataset.absent else ran


def read_data(
    dataset: str | os.PathLike,
    root: str | os.PathLike | None,
    sequences: str | Iterable[str] | None,
    list_file: str | os.PathLike | None,
) -> DataChoice:
    """Return the sequences that the arguments of a call ask for; raises InputError on one of another kind."""
    check_kinds(Kind.PATH, dataset=dataset)
    check_kinds(Kind.PATH, optional=True, root=root, list_file=list_file)
    dataset = os.fsdecode(dataset)
    if dataset not in DATASETS and root is None and os.path.isdir(dataset):
        dataset, root = "folder", dataset
    names = None if sequences is None else read_names("sequences", sequences)
    if names == ():
        raise InputError("no sequence named", where="sequences", got=repr(sequences), expected="some, or None for all")
    paths = (None if path is None else os.fsdecode(path) for path in (root, list_file))
    return DataChoice(dataset, next(paths), names, next(paths))


def read_variants(names: Sequence[str] | None, kind: type[AnyVariant], dataset: str) -> tuple[AnyVariant, ...]:
    """Return the variants named, each once, or all of `kind` where None; raises InputError on one of another kind."""
    known = [variant.value for variant in kind]
    if names is None:
        return tuple(kind)
    if not names:
        raise InputError("no variant named", where="--variant", got=repr(names), expected=" or ".join(known))
    for name in names:
        if name not in known:
            what, expected = f"variant of data set {dataset}", " or ".join(known)
            raise unknown_name(what, str(name), known, where="--variant", expected=expected)
    return tuple(kind(name) for name in dict.fromkeys(names))


def open_sequences(dataset: Dataset, config: PipelineConfig, choices: PipelineChoices) -> list[SequenceSource]:
    """Open the sequences of a data set, with the cues that are given as folders."""
    return [with_given_folders(dataset.sequence(name), choices.folders, config.max_side) for name in dataset.names]


def write_report_json(path: str | Path, report: Report) -> None:
    """Write a report as ``--json`` does; raises InputError where the file cannot be written."""
    write_text(path, report.model_dump_json(indent=2, exclude_none=True) + "\n")
