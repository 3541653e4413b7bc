"""Options of evaluations on labelled trajectories."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import typer

from moseg.workflows.config.trajectory_choices import TrajectoryChoices


@dataclass(frozen=True)
class TrajectoryOptions:
    """Views and seeds, of labelled trajectories only."""

    PANEL: ClassVar[str] = "Labelled trajectories (kt3dmoseg)"

    views: Annotated[
        str | None,
        typer.Option(
            "--views",
            help="Point models that `fused` combines (default: affine,homography,fundamental).",
            metavar="NAMES",
        ),
    ] = None
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Seed of the random draws (default: 0).", metavar="N")
    ] = None
    seeds: Annotated[
        int | None, typer.Option("--seeds", min=1, help="Mean and spread over the seeds 0 to N - 1.", metavar="N")
    ] = None

    def choices(self) -> TrajectoryChoices:
        """Return what these options say."""
        views = None if self.views is None else tuple(name.strip() for name in self.views.split(","))
        return TrajectoryChoices(views, self.seed, self.seeds)
