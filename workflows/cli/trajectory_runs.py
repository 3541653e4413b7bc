"""What `moseg eval`, `moseg ablate` and `moseg plan` do on a data set of labelled trajectories."""

from collections.abc import Sequence

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.workflows.cli.options import RunOptions
from moseg.workflows.datasets import Dataset
from moseg.workflows.pipelines.purpose import Purpose


def evaluate_clips(
    dataset: Dataset,
    config: PipelineConfig,
    run: RunOptions,
    variants: Sequence[TrajectoryVariant],
    seeds: Sequence[int] | None,
    purpose: Purpose,
    json: str | None,
    page: str | None,
):
    """The result, written to `json` and shown on `page` where asked, the use of the store by stage, what a reader must
    know, and the lines that name the files beside `json`."""
    from moseg.workflows.exports import write_text
    from moseg.workflows.pipelines.evaluate_trajectories import evaluate_trajectories
    from moseg.workflows.reports.run_report import RunReport
    from moseg.workflows.reports.score_tables import clip_tables

    sources = [dataset.trajectories(name) for name in dataset.names]
    notes = _notes(dataset, config, variants, seeds)
    shown = None if page is None else RunReport(page, dataset.name, config, variants, dataset.names, seeds)
    with run.open() as session:
        panels = None if shown is None else shown.panels
        report = evaluate_trajectories(
            session, dataset.name, sources, config, variants, seeds, purpose._replace(notes=notes), panels
        )
        if shown is not None:
            shown.note_facts(session)
    if json is not None:
        write_text(json, report.model_dump_json(indent=2, exclude_none=True) + "\n")
    lines = () if shown is None else (shown.write(clip_tables(report.dataset, report.rows), notes),)
    return report, session.stages(), notes, lines


def _notes(
    dataset: Dataset, config: PipelineConfig, variants: Sequence[TrajectoryVariant], seeds: Sequence[int] | None
) -> tuple[str, ...]:
    absent = f"; not on disk: {', '.join(dataset.absent)}" if dataset.absent else ""
    notes = [f"{len(dataset.names)} of the {len(dataset.layout.official)} clips ran{absent}"]
    motions = config.clustering.motions
    notes.append(f"number of motions: {'given (gt)' if motions == 'gt' else motions}")
    if TrajectoryVariant.FUSED in variants:
        notes.append(f"views of fused: {', '.join(config.fused_point_models)}")
    if seeds is not None:
        notes.append(f"mean over seeds {', '.join(map(str, seeds))}")
    return tuple(notes)
