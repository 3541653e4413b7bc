"""`moseg eval`, `moseg ablate` and `moseg plan`."""

from schemas.configs import PipelineConfig, Variant
from schemas.errors import MissingStoreError
from workflows.cli.options import (
    DEFAULT_STORE,
    AffinityOption,
    DatasetOption,
    DepthOption,
    FlowOption,
    JsonOption,
    ListFileOption,
    MotionsOption,
    ProposalsOption,
    QuietOption,
    RootOption,
    SchedulerOption,
    SectionOption,
    SequencesOption,
    SetOption,
    StoreOption,
    TracksOption,
    VariantsOption,
    WorkersOption,
    make_config,
    sequence_names,
)


def evaluate(
    dataset: DatasetOption = "synthetic",
    root: RootOption = None,
    variant: VariantsOption = None,
    sequences: SequencesOption = None,
    list_file: ListFileOption = None,
    motions: MotionsOption = None,
    proposals: ProposalsOption = None,
    depth: DepthOption = None,
    flow: FlowOption = None,
    tracks: TracksOption = None,
    affinity: AffinityOption = None,
    section_length: SectionOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
    store: StoreOption = DEFAULT_STORE,
    workers: WorkersOption = 0,
    scheduler: SchedulerOption = None,
    quiet: QuietOption = False,
) -> None:
    """Score variants of the pipeline on a data set.

    Example: moseg eval --dataset davis16 --root DAVIS --variant fused --json fused.json
    """
    config, folders = make_config(motions, proposals, depth, flow, tracks, affinity, section_length, settings)
    _evaluate(
        (dataset, root, sequences, list_file),
        config,
        folders,
        tuple(variant or (Variant.FUSED,)),
        (store, workers, scheduler, quiet),
        json,
        ablation=False,
    )


def ablate(
    dataset: DatasetOption = "synthetic",
    root: RootOption = None,
    sequences: SequencesOption = None,
    list_file: ListFileOption = None,
    motions: MotionsOption = None,
    proposals: ProposalsOption = None,
    depth: DepthOption = None,
    flow: FlowOption = None,
    tracks: TracksOption = None,
    affinity: AffinityOption = None,
    section_length: SectionOption = None,
    settings: SetOption = None,
    json: JsonOption = None,
    store: StoreOption = DEFAULT_STORE,
    workers: WorkersOption = 0,
    scheduler: SchedulerOption = None,
    quiet: QuietOption = False,
) -> None:
    """The paper's ablation: all five variants in one table, with the artifacts computed and reused.

    Example: moseg ablate --dataset synthetic --proposals groundtruth --depth groundtruth
    """
    config, folders = make_config(motions, proposals, depth, flow, tracks, affinity, section_length, settings)
    _evaluate(
        (dataset, root, sequences, list_file),
        config,
        folders,
        tuple(Variant),
        (store, workers, scheduler, quiet),
        json,
        ablation=True,
    )


def plan(
    dataset: DatasetOption = "synthetic",
    root: RootOption = None,
    variant: VariantsOption = None,
    sequences: SequencesOption = None,
    list_file: ListFileOption = None,
    motions: MotionsOption = None,
    proposals: ProposalsOption = None,
    depth: DepthOption = None,
    flow: FlowOption = None,
    tracks: TracksOption = None,
    affinity: AffinityOption = None,
    section_length: SectionOption = None,
    settings: SetOption = None,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """What `moseg eval` with the same options would compute and reuse; nothing is computed or stored.

    Example: moseg plan --dataset davis16 --root DAVIS --variant fused --variant oc
    """
    from store import open_store
    from workflows.cli.tables import print_stages
    from workflows.datasets import open_dataset
    from workflows.given_folders import with_given_folders
    from workflows.plan_evaluation import EmptyStore, plan_evaluation

    config, folders = make_config(motions, proposals, depth, flow, tracks, affinity, section_length, settings)
    data = open_dataset(dataset, root, sequence_names(sequences), list_file, max_side=config.max_side)
    sources = [with_given_folders(data.sequence(name), folders, config.max_side) for name in data.names]
    try:
        opened = open_store(store, create=False)
    except MissingStoreError:
        opened = EmptyStore()
    stages = plan_evaluation(opened, sources, config, tuple(variant or (Variant.FUSED,)))
    print_stages(stages)
    computed, reused = (sum(use[i] for use in stages.values()) for i in (0, 1))
    print(f"{computed} artifacts to compute, {reused} to reuse")


def _evaluate(
    data: tuple[str, str | None, str | None, str | None],
    config: PipelineConfig,
    folders: dict[str, str],
    variants: tuple[Variant, ...],
    running: tuple[str, int, str | None, bool],
    json: str | None,
    ablation: bool,
) -> None:
    from workflows.cli.tables import print_ablation, print_report, print_stages
    from workflows.datasets import open_dataset
    from workflows.evaluate import evaluate as run_evaluation
    from workflows.exports import check_writable, write_text
    from workflows.given_folders import with_given_folders
    from workflows.runs import open_session

    name, root, sequences, list_file = data
    if json is not None:
        check_writable(json)
    dataset = open_dataset(name, root, sequence_names(sequences), list_file, max_side=config.max_side)
    sources = [with_given_folders(dataset.sequence(name), folders, config.max_side) for name in dataset.names]
    with open_session(*running) as session:
        report = run_evaluation(session, dataset.name, sources, config, variants)
    notes = (*_notes(config, variants), *(f"{absent} is not on disk" for absent in dataset.absent))
    if ablation:
        print_ablation(report, notes)
        print_stages(session.stages())
        print(f"{report.store.computed} artifacts computed, {report.store.reused} reused, {report.seconds:.1f} s")
    else:
        print_report(report, notes)
    if json is not None:
        write_text(json, report.model_dump_json(indent=2) + "\n")


def _notes(config: PipelineConfig, variants: tuple[Variant, ...]) -> tuple[str, ...]:
    """What a reader must know to read the figures rightly."""
    notes = [f"proposals {config.proposal_source}, flow {config.flow.method}, tracks {config.tracks.method}"]
    if config.depth.method == "none":
        without = [variant.value for variant in (Variant.FUSED, Variant.OC_DEPTH, Variant.OC) if variant in variants]
        if without:
            notes.append(f"no depth given: {', '.join(without)} ran without it (oc_depth with constant inverse depth)")
    else:
        notes.append(f"depth {config.depth.method}")
    return tuple(notes)
