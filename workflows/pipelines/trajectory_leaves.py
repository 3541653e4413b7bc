"""From a clip's sources to the leaves of its graph."""

from collections.abc import Sequence

from moseg.workflows.datasets import TrajectorySource
from moseg.workflows.engine.ingest import IngestJob
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import TrajectoryLeaves


def ingest_trajectories(session: Session, sources: Sequence[TrajectorySource]) -> list[TrajectoryLeaves]:
    """Leaves of every clip; raises InputError where one cannot be read."""
    found = iter(session.ingest([job for source in sources for job in trajectory_jobs(source)]))
    return [make_trajectory_leaves(source, next(found), next(found)) for source in sources]


def trajectory_jobs(source: TrajectorySource) -> tuple[IngestJob, IngestJob]:
    """What must be decoded of a clip: its trajectories and their labels."""
    # They share a file: what is wrong with it is said once.
    batch = f"trajectories {source.name}"
    return IngestJob("trajectories", source.trajectories, batch), IngestJob("trajectory_labels", source.labels, batch)


def make_trajectory_leaves(source: TrajectorySource, trajectories: dict, labels: dict) -> TrajectoryLeaves:
    """Leaves of a clip from what its jobs gave."""
    return TrajectoryLeaves(
        name=source.name,
        trajectories=trajectories["leaves"][0],
        labels=labels["leaves"][0],
        num_motions=len(labels["labels"]),
    )
