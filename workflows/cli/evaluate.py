"""`moseg eval`, `moseg ablate` and `moseg plan`."""

import os

from schemas.configs import PipelineConfig, Variant
from schemas.errors import MissingStoreError
from workflows.cli.notes import motions_note
from workflows.cli.options import (
    DEFAULT_STORE,
    DataOptions,
    JsonOption,
    PipelineOptions,
    RunOptions,
    StoreOption,
    VariantsOption,
    with_option_groups,
)


@with_option_groups
def evaluate(
    data: DataOptions,
    pipeline: PipelineOptions,
    run: RunOptions,
    variant: VariantsOption = None,
    json: JsonOption = None,
) -> None:
    """Score variants of the pipeline on a data set.

    Example: moseg eval --dataset davis16 --root DAVIS --variant fused --json fused.json
    """
    from workflows.cli.tables import print_report

    report, _, notes = _evaluate(data, pipeline, run, tuple(variant or (Variant.FUSED,)), json)
    print_report(report, notes)


@with_option_groups
def ablate(data: DataOptions, pipeline: PipelineOptions, run: RunOptions, json: JsonOption = None) -> None:
    """The paper's ablation: all five variants in one table, with the artifacts computed and reused.

    Example: moseg ablate --dataset synthetic --proposals groundtruth --depth groundtruth
    """
    from workflows.cli.tables import print_ablation, print_stages

    report, stages, notes = _evaluate(data, pipeline, run, tuple(Variant), json)
    print_ablation(report, notes)
    print_stages(stages)
    print(f"{report.store.computed} artifacts computed, {report.store.reused} reused, {report.seconds:.1f} s")


@with_option_groups
def plan(
    data: DataOptions, pipeline: PipelineOptions, variant: VariantsOption = None, store: StoreOption = DEFAULT_STORE
) -> None:
    """What `moseg eval` with the same options would compute and reuse; nothing is computed or stored.

    Example: moseg plan --dataset davis16 --root DAVIS --variant fused --variant oc
    """
    from store import open_store
    from workflows.cli.tables import print_stages
    from workflows.plan_evaluation import EmptyStore, plan_evaluation
    from workflows.weights.fetch_command import fetch_command
    from workflows.weights.folder import open_weights
    from workflows.weights.needed import needed_items

    config, folders = pipeline.read()
    _, sources = _open(data, config, folders)
    try:
        opened = open_store(store, create=False)
    except MissingStoreError:
        opened = EmptyStore()
    weights = open_weights(os.environ, offline=True, allow_non_commercial=True)
    stages = plan_evaluation(opened, sources, config, tuple(variant or (Variant.FUSED,)), weights)
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
    run: RunOptions,
    variants: tuple[Variant, ...],
    json: str | None,
):
    """The report, written to `json` where asked, the use of the store by stage, and what a reader must know."""
    from workflows.evaluate import evaluate as run_evaluation
    from workflows.exports import check_writable, write_text

    config, folders = pipeline.read()
    if json is not None:
        check_writable(json)
    dataset, sources = _open(data, config, folders)
    with run.open() as session:
        report = run_evaluation(session, dataset.name, sources, config, variants)
    if json is not None:
        write_text(json, report.model_dump_json(indent=2) + "\n")
    notes = (*_notes(config, variants), *(f"{absent} is not on disk" for absent in dataset.absent))
    return report, session.stages(), notes


def _open(data: DataOptions, config: PipelineConfig, folders: dict[str, str]):
    """The data set and the sources of its sequences, given cues included."""
    from workflows.given_folders import with_given_folders

    dataset = data.open(config.max_side)
    return dataset, [with_given_folders(dataset.sequence(name), folders, config.max_side) for name in dataset.names]


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
            notes.append(f"no depth given: {', '.join(without)} ran without it (oc_depth with constant inverse depth)")
    else:
        notes.append(f"depth {config.depth.method}")
    return (*notes, *motions_note(config))
