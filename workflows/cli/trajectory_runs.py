"""What `moseg eval`, `moseg ablate` and `moseg plan` do on a data set of labelled trajectories."""

from collections.abc import Sequence

from schemas.configs import PipelineConfig, TrajectoryVariant
from workflows.cli.options import RunOptions
from workflows.datasets import Dataset


def evaluate_clips(
    dataset: Dataset,
    config: PipelineConfig,
    run: RunOptions,
    variants: Sequence[TrajectoryVariant],
    seeds: Sequence[int] | None,
    json: str | None,
):
    """The report, written to `json` where asked, the use of the store by stage, and what a reader must know."""
    from workflows.evaluate_trajectories import evaluate_trajectories
    from workflows.exports import write_text

    sources = [dataset.trajectories(name) for name in dataset.names]
    with run.open() as session:
        report = evaluate_trajectories(session, dataset.name, sources, config, variants, seeds)
    if json is not None:
        write_text(json, report.model_dump_json(indent=2, exclude_none=True) + "\n")
    return report, session.stages(), _notes(dataset, config, variants, seeds)


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
