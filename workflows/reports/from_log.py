"""Report of a finished or running run, from its log and the artifacts still stored; nothing is computed."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from importlib.metadata import version

from moseg.schemas.configs import TrajectoryVariant, Variant, seeded_configs
from moseg.schemas.errors import CorruptArtifactError, InputError, MissingArtifactError, StoreError
from moseg.schemas.scores import AnyScore, GroundTruth, score_class
from moseg.schemas.trajectory_scores import TrajectoryScore, average_row
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph, SequenceLeaves, TrajectoryGraph, make_graph
from moseg.workflows.process.progress import PATIENCE_SEC, StageProgress
from moseg.workflows.reports.content import ReportPage, ScoreTable
from moseg.workflows.reports.equal_rows import equality_notes
from moseg.workflows.reports.facts import facts_of_log
from moseg.workflows.reports.missing import WhyAbsent
from moseg.workflows.reports.panels import NUM_FRAMES, Panels, choose_shown
from moseg.workflows.reports.run_report import build_page, panel_notes
from moseg.workflows.reports.score_tables import clip_tables, score_tables
from moseg.workflows.reports.subject import RunSubject, read_subject
from moseg.workflows.runlog.status import RunState, find_run, read_status


def report_run(
    store: ArtifactStore,
    run: str,
    sequences: Sequence[str] | None = None,
    num_frames: int = NUM_FRAMES,
    quiet: bool = True,
) -> ReportPage:
    """Return the page of a run as far as its artifacts are stored.

    Parameters
    ----------
    run : str
        As `moseg.workflows.runlog.status.find_run` takes it.
    sequences : sequence of str, optional
        Those to show; the first ones where None.
    num_frames : int
        Frames of each.
    quiet : bool
        No progress on standard error.

    Raises
    ------
    InputError
        There is no such run, its log does not name its subject, or it has none of these sequences.
    StoreError
        The log cannot be read, or an artifact is damaged.
    """
    run_id = find_run(store, run)
    subject = read_subject(store, run_id)
    names = tuple(sequence.leaves.name for sequence in subject.sequences)
    unknown = [name for name in sequences or () if name not in names]
    if unknown:
        expected = ", ".join(names[:20]) + (", …" if len(names) > 20 else "")
        raise InputError("no such sequence", where=f"run {run_id}", got=unknown[0], expected=expected)
    status = read_status(store, run_id)
    shown = choose_shown(names, sequences)
    why_absent = WhyAbsent.GONE if status.state == RunState.FINISHED else WhyAbsent.NOT_YET
    panels = Panels(subject.config, subject.variants, shown, num_frames, why_absent)
    try:
        gather = _gather_frames if subject.has_frames else _gather_clips
        with StageProgress({"report": len(names)}, quiet, "sequences", PATIENCE_SEC) as progress:
            read = progress.each("report", subject.sequences)
            tables, absent = gather(store, subject, panels, read, why_absent)
    except CorruptArtifactError as error:
        raise _damaged(store, error) from error
    num_wanted = len(names) if sequences is None else len(shown)
    notes = [*subject.notes, *panel_notes(num_wanted, len(shown), subject.seeds), *absent]
    if status.version != version("moseg"):
        notes.append(f"made by moseg {status.version}, shown by {version('moseg')}: what has changed since is missing")
    if status.state != RunState.FINISHED:
        notes.append(f"the run is {status.state}: results that it has not computed yet are missing")
    about = subject.dataset or names[0]
    facts = facts_of_log(store, status)
    found = [panels.found[name] for name in shown]
    return build_page(about, subject.variants, subject.config, facts, notes, tables, found)


def _gather_frames(
    store: ArtifactStore, subject: RunSubject, panels: Panels, sequences: Iterable, why_absent: WhyAbsent
) -> tuple[tuple[ScoreTable, ...], tuple[str, ...]]:
    """Return score tables and notes on absent scores, and gather the panels, so that one graph is held at a time."""
    scores: dict[str, dict[str, AnyScore | None]] = {variant.value: {} for variant in subject.variants}
    for leaves, fps in sequences:
        graph = make_graph(leaves, subject.config)
        if subject.command != "segment":
            for variant in subject.variants:
                scores[variant.value][leaves.name] = _score(store, graph, variant)
        panels.gather(store, graph, fps)
    if subject.command == "segment":
        return (), ()
    found = [score for by_name in scores.values() for score in by_name.values()]
    tables = score_tables(subject.dataset, _over(subject.sequences[0].leaves), scores)
    absent = _note_absent(found.count(None), len(found), why_absent, "their cells and the means are empty")
    return tables, (*equality_notes(scores), *absent)


def _gather_clips(
    store: ArtifactStore, subject: RunSubject, panels: Panels, sequences: Iterable, why_absent: WhyAbsent
) -> tuple[tuple[ScoreTable, ...], tuple[str, ...]]:
    """Do the same for trajectories: a clip without a score of a variant is left out of that variant's table."""
    configs = seeded_configs(subject.config, subject.seeds)
    rows = {variant: {seed: {} for seed in configs} for variant in subject.variants}
    num_absent = 0
    for leaves, _ in sequences:
        graphs = {seed: TrajectoryGraph(leaves, config) for seed, config in configs.items()}
        for variant, by_seed in rows.items():
            scores = {seed: _score(store, graph, variant) for seed, graph in graphs.items()}
            if None in scores.values():
                num_absent += 1
                continue
            for seed, score in scores.items():
                by_seed[seed][leaves.name] = score
        panels.gather(store, next(iter(graphs.values())))
    groups = {leaves.name: leaves.groups for leaves, _ in subject.sequences}
    complete = {variant: by_seed for variant, by_seed in rows.items() if all(by_seed.values())}
    known = tuple(average_row(variant.value, by_seed, groups) for variant, by_seed in complete.items())
    tables = clip_tables(subject.dataset, known) if known else ()
    num_all = len(subject.sequences) * len(subject.variants)
    return tables, _note_absent(num_absent, num_all, why_absent, "the means are of the others")


def _score(
    store: ArtifactStore, graph: SequenceGraph | TrajectoryGraph, variant: Variant | TrajectoryVariant
) -> AnyScore | TrajectoryScore | None:
    kind = TrajectoryScore if isinstance(graph, TrajectoryGraph) else score_class(_over(graph.leaves))
    with suppress(MissingArtifactError):
        return kind(**store.attributes(graph.score(variant)))
    return None


def _over(leaves: SequenceLeaves) -> GroundTruth:
    if leaves.annotation is not None:
        return "pixels"
    return "still" if leaves.nothing_moves else "points"


def _note_absent(num_absent: int, num_all: int, why: WhyAbsent, effect: str) -> tuple[str, ...]:
    if not num_absent:
        return ()
    gone = "not in the store (collected since, or never computed)"
    return (f"{num_absent} of {num_all} scores are {gone if why == WhyAbsent.GONE else 'not computed yet'}: {effect}",)


def _damaged(store: ArtifactStore, error: CorruptArtifactError) -> StoreError:
    """Return an error that names the command which repairs damage: nothing is computed here."""
    expected = (
        f"whole artifacts: `moseg store verify --quarantine --store {store.url}` takes the damaged ones out of service;"
        " the run's own command with --report computes them anew"
    )
    return StoreError("damaged artifact", where=error.ref, got=error.parts[0], expected=expected)
