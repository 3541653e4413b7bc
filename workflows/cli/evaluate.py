"""`moseg eval`, `moseg ablate` and `moseg plan`."""

import os
from typing import Literal

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.schemas.errors import MissingStoreError
from moseg.schemas.trajectory_scores import TrajectoryReport
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import (
    DEFAULT_STORE,
    DataOptions,
    JsonOption,
    ReportOption,
    RunOptions,
    StoreOption,
    VariantName,
    VariantsOption,
    read_variants,
)
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.cli.trajectory_options import TrajectoryOptions
from moseg.workflows.config.notes import motions_note


@with_option_groups
def evaluate(
    data: DataOptions,
    pipeline: PipelineOptions,
    trajectories: TrajectoryOptions,
    run: RunOptions,
    variant: VariantsOption = None,
    json: JsonOption = None,
    page: ReportOption = None,
) -> None:
    """Score variants of the pipeline on a data set.

    Examples
    --------
    moseg eval --dataset synthetic
    moseg eval --dataset davis16 --root DAVIS --variant fused --json fused.json
    moseg eval --dataset kt3dmoseg --motions gt --seeds 5
    moseg eval --config my-config.yaml --sequences dog,blackswan --dataset davis16
    """
    report, _, notes, lines = _evaluate(data, pipeline, trajectories, run, variant, json, page)
    if isinstance(report, TrajectoryReport):
        from moseg.workflows.cli.trajectory_tables import print_trajectory_report as print_report
    else:
        from moseg.workflows.cli.tables import print_report

    print_report(report, notes)
    for line in lines:
        print(line)


@with_option_groups
def ablate(
    data: DataOptions,
    pipeline: PipelineOptions,
    trajectories: TrajectoryOptions,
    run: RunOptions,
    json: JsonOption = None,
    page: ReportOption = None,
) -> None:
    """The paper's ablation: all five variants in one table, with the artifacts computed and reused.

    On labelled trajectories: all views fused, and each of the three models alone.

    Examples
    --------
    moseg ablate --dataset synthetic --proposals groundtruth --depth groundtruth
    moseg ablate --dataset kt3dmoseg --motions gt
    """
    from moseg.workflows.cli.tables import print_stages

    report, stages, notes, lines = _evaluate(data, pipeline, trajectories, run, "all", json, page)
    if isinstance(report, TrajectoryReport):
        from moseg.workflows.cli.trajectory_tables import print_trajectory_ablation as print_ablation
    else:
        from moseg.workflows.cli.tables import print_ablation

    print_ablation(report, notes)
    print_stages(stages)
    print(f"{report.store.computed} artifacts computed, {report.store.reused} reused, {report.seconds:.1f} s")
    for line in lines:
        print(line)


@with_option_groups
def plan(
    data: DataOptions,
    pipeline: PipelineOptions,
    trajectories: TrajectoryOptions,
    variant: VariantsOption = None,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """What `moseg eval` with the same options would compute and reuse; nothing is computed or stored.

    Examples
    --------
    moseg plan --dataset davis16 --root DAVIS --variant fused --variant oc
    moseg plan --preset paper
    """
    from moseg.store import open_store
    from moseg.workflows.cli.tables import print_stages
    from moseg.workflows.pipelines.plan_evaluation import EmptyStore, plan_evaluation
    from moseg.workflows.pipelines.plan_trajectories import plan_trajectories
    from moseg.workflows.stages.needed_weights import needed_items
    from moseg.workflows.weights.fetch_command import fetch_command
    from moseg.workflows.weights.folder import open_weights

    config, folders = pipeline.read()
    dataset = data.open(config.max_side)
    try:
        opened = open_store(store, create=False)
    except MissingStoreError:
        opened = EmptyStore()
    weights = open_weights(os.environ, offline=True, allow_non_commercial=True)
    if dataset.has_frames:
        trajectories.refuse(dataset.name)
        variants = read_variants(variant, Variant, dataset.name)
        stages = plan_evaluation(opened, _open(dataset, config, folders), config, variants, weights)
    else:
        config = trajectories.apply(pipeline, config, dataset.name)
        variants = read_variants(variant, TrajectoryVariant, dataset.name)
        sources = [dataset.trajectories(name) for name in dataset.names]
        stages = plan_trajectories(opened, sources, config, variants, trajectories.all_seeds)
    print_stages(stages)
    computed, reused = (sum(use[i] for use in stages.values()) for i in (0, 1))
    print(f"{computed} artifacts to compute, {reused} to reuse")
    absent = [name for name in needed_items(config) if not weights.is_present(weights.item(name))]
    if absent:
        command = fetch_command(*(weights.item(name) for name in absent))
        print(f"weights to fetch: {', '.join(absent)} ({command})")


def _evaluate(
    data: DataOptions,
    pipeline: PipelineOptions,
    trajectories: TrajectoryOptions,
    run: RunOptions,
    variant: list[VariantName] | Literal["all"] | None,
    json: str | None,
    page: str | None,
):
    """The result, written to `json` and shown on `page` where asked, the use of the store by stage, what a reader must
    know, and the lines that name the files beside `json`."""
    from moseg.workflows.cli.trajectory_runs import evaluate_clips
    from moseg.workflows.exports import check_writable, write_text
    from moseg.workflows.pipelines.evaluate import evaluate as run_evaluation
    from moseg.workflows.pipelines.purpose import Purpose
    from moseg.workflows.reports.run_report import RunReport
    from moseg.workflows.reports.score_tables import score_tables

    config, folders = pipeline.read()
    if json is not None:
        check_writable(json)
    dataset = data.open(config.max_side)
    kind = Variant if dataset.has_frames else TrajectoryVariant
    command = "ablate" if variant == "all" else "eval"
    variants = tuple(kind) if variant == "all" else read_variants(variant, kind, dataset.name)
    if not dataset.has_frames:
        config = trajectories.apply(pipeline, config, dataset.name)
        return evaluate_clips(dataset, config, run, variants, trajectories.all_seeds, Purpose(command), json, page)
    trajectories.refuse(dataset.name)
    sources = _open(dataset, config, folders)
    notes = (*_notes(config, variants), *(f"{absent} is not on disk" for absent in dataset.absent))
    shown = None if page is None else RunReport(page, dataset.name, config, variants, dataset.names)
    with run.open() as session:
        panels = None if shown is None else shown.panels
        report = run_evaluation(session, dataset.name, sources, config, variants, Purpose(command, notes), panels)
        if shown is not None:
            shown.note_facts(session)
    if json is not None:
        write_text(json, report.model_dump_json(indent=2, exclude_none=True) + "\n")
    tables = score_tables(report.dataset, report.over, {row.variant: row.sequences for row in report.rows})
    lines = () if shown is None else (shown.write(tables, notes),)
    return report, session.stages(), notes, lines


def _open(dataset, config: PipelineConfig, folders: dict[str, str]):
    """The sources of a data set's sequences, given cues included."""
    from moseg.workflows.datasets.given_folders import with_given_folders

    return [with_given_folders(dataset.sequence(name), folders, config.max_side) for name in dataset.names]


def _notes(config: PipelineConfig, variants: tuple[Variant, ...]) -> tuple[str, ...]:
    """What a reader must know to read the figures rightly."""
    proposals = config.proposal_source
    if proposals == "detections":
        chosen = config.detections
        named = chosen.tagger if chosen.tags is None else f"tags {', '.join(chosen.tags)}"
        proposals += f" ({named}; grounding-dino; {chosen.masks}; {chosen.tracker})"
    notes = [f"proposals {proposals}, flow {config.flow.method}, tracks {config.tracks.method}"]
    if config.depth.method == "none":
        without = [variant.value for variant in (Variant.FUSED, Variant.OC_DEPTH, Variant.OC) if variant in variants]
        if without:
            notes.append(f"no depth given: {', '.join(without)} ran without it (oc-depth with constant inverse depth)")
    else:
        notes.append(f"depth {config.depth.method}")
    return (*notes, *motions_note(config))
