"""Options of evaluations on labelled trajectories, and which of the others mean nothing there."""

from dataclasses import dataclass, fields
from typing import Annotated, ClassVar

import typer

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.parameters import list_parameters, value_of

READ_PARAMETERS = ("fused_point_models", "clustering.motions", "hypotheses.", "kernel.", "trajectory_clustering.")
"""Parameters, and stages of parameters, that trajectories without images read."""
READ_OPTIONS = ("motions", "settings", "config_file")


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

    @property
    def all_seeds(self) -> range | None:
        """Seeds to average over; None where a single run is asked for."""
        return None if self.seeds is None else range(self.seeds)

    def refuse(self, dataset: str) -> None:
        """Raise InputError where one is given for a data set of frames."""
        for field in fields(self):
            if getattr(self, field.name) is not None:
                where, got = f"--{field.name}", f"data set {dataset}"
                raise InputError("an option of labelled trajectories", where=where, got=got, expected="kt3dmoseg")

    def apply(self, pipeline: PipelineOptions, config: PipelineConfig, dataset: str) -> PipelineConfig:
        """The configuration with these options; raises InputError where another option needs images."""
        from moseg.tasks.point_models import POINT_MODELS

        _refuse_images(pipeline, dataset)
        if self.seed is not None and self.seeds is not None:
            raise InputError("two choices", where="--seed", got=f"--seeds {self.seeds} too", expected="one of them")
        chosen = {}
        if self.views is not None:
            chosen["fused_point_models"] = tuple(name.strip() for name in self.views.split(","))
        if self.seed is not None:
            chosen["hypotheses"] = config.hypotheses.model_copy(update={"seed": self.seed})
        config = config.model_copy(update=chosen)
        known = [name for name, model in POINT_MODELS.items() if not model.needs_depth]
        names = config.fused_point_models
        if not set(names) <= set(known) or len(set(names)) < len(names):
            expected = f"different ones of {', '.join(known)}, separated by commas"
            where = "fused_point_models" if self.views is None else "--views"
            raise InputError("not point models", where=where, got=",".join(names), expected=expected)
        return config


def _refuse_images(pipeline: PipelineOptions, dataset: str) -> None:
    """Raise InputError where an option is given that only frames have a use for."""
    got = f"data set {dataset}, trajectories without images"
    for field in fields(pipeline):
        if field.name not in READ_OPTIONS and getattr(pipeline, field.name) != field.default:
            option = f"--{field.name.replace('_', '-')}"
            raise InputError("an option for images", where=option, got=got, expected="a data set of frames")
    for setting in pipeline.settings or ():
        name = setting.partition("=")[0].strip()
        if not name.startswith(READ_PARAMETERS):
            expected = " or ".join(name.removesuffix(".") for name in READ_PARAMETERS)
            raise InputError("a parameter for images", where=f"--set {name}", got=got, expected=expected)
    # A full file has them all; what it leaves as it is by default changes nothing.
    in_file = PipelineConfig.model_validate(pipeline.read_file())
    for name, parameter in list_parameters().items():
        if not name.startswith(READ_PARAMETERS) and value_of(in_file, parameter) != parameter.default:
            where = f"{pipeline.config_file}: {name}"
            raise InputError("a parameter for images", where=where, got=got, expected="its default, or none")
