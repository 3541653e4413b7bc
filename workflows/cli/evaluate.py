"""`moseg eval`, `moseg ablate`, `moseg plan` and `moseg score`."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import typer

from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import (
    DEFAULT_STORE,
    DataOptions,
    JsonOption,
    QuietOption,
    ReportOption,
    RunOptions,
    StoreOption,
    VariantName,
    VariantsOption,
)
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.trajectory_choices import TrajectoryChoices

DEFAULT_VARIANTS = [VariantName.FUSED]


@dataclass(frozen=True)
class TrajectoryOptions:
    """Views and seeds, of labelled trajectories only."""

    PANEL: ClassVar[str] = "Labelled trajectories (kt3dmoseg, hopkins155, hopkins12, mtpv62)"

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
        """Return the choices that these options make."""
        views = None if self.views is None else tuple(name.strip() for name in self.views.split(","))
        return TrajectoryChoices(views, self.seed, self.seeds)


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
    moseg eval --dataset hopkins155 --root Hopkins155 --motions gt
    moseg eval --config my-config.yaml --sequences dog,blackswan --dataset davis16
    """
    from moseg.workflows.api.evaluation import run_evaluation
    from moseg.workflows.cli.tables import print_report

    choices, settings = (pipeline.choices(), trajectories.choices()), run.settings()
    done = run_evaluation("eval", data.choice(), *choices, settings, variant or DEFAULT_VARIANTS, json, page)
    print_report(done.report)
    if done.page is not None:
        print(done.page)


@with_option_groups
def ablate(
    data: DataOptions,
    pipeline: PipelineOptions,
    trajectories: TrajectoryOptions,
    run: RunOptions,
    json: JsonOption = None,
    page: ReportOption = None,
) -> None:
    """Score the paper's ablation: all five variants in one table, with the artifacts computed and reused.

    On labelled trajectories: all views fused, and each of the three models alone.

    Examples
    --------
    moseg ablate --dataset synthetic --proposals groundtruth --depth groundtruth
    moseg ablate --dataset kt3dmoseg --motions gt
    """
    from moseg.workflows.api.evaluation import run_evaluation
    from moseg.workflows.cli.tables import print_ablation, print_stages, print_use

    choices, settings = (pipeline.choices(), trajectories.choices()), run.settings()
    done = run_evaluation("ablate", data.choice(), *choices, settings, None, json, page)
    print_ablation(done.report)
    print_stages(done)
    print_use(done.report)
    if done.page is not None:
        print(done.page)


@with_option_groups
def plan(
    data: DataOptions,
    pipeline: PipelineOptions,
    trajectories: TrajectoryOptions,
    variant: VariantsOption = None,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Show what `moseg eval` with the same options would compute and reuse; nothing is computed or stored.

    Examples
    --------
    moseg plan --dataset davis16 --root DAVIS --variant fused --variant oc
    moseg plan --preset paper
    """
    from moseg.workflows.api.evaluation import run_plan
    from moseg.workflows.cli.tables import print_stages
    from moseg.workflows.weights.fetch_command import fetch_command

    choices = pipeline.choices(), trajectories.choices()
    planned = run_plan(data.choice(), *choices, store, variant or DEFAULT_VARIANTS)
    print_stages(planned)
    computed, reused = (sum(use[i] for use in planned.stages.values()) for i in (0, 1))
    print(f"{computed} artifacts to compute, {reused} to reuse")
    if planned.num_open_choices:
        count = planned.num_open_choices
        stretches = f"{count} stretch{'' if count == 1 else 'es'} of video"
        print(f"the proposals of {stretches} are not chosen yet: the rest is counted as if saliency were")
    if planned.missing_weights:
        names = ", ".join(item.name for item in planned.missing_weights)
        print(f"weights to fetch: {names} ({fetch_command(*planned.missing_weights)})")


@with_option_groups
def score(
    predictions: Annotated[str, typer.Option("--predictions", help="Folder of saved masks.")],
    data: DataOptions,
    format: Annotated[
        str | None, typer.Option("--format", help="Format of the masks (default: found from the files' names).")
    ] = None,
    name: Annotated[str | None, typer.Option("--name", help="Name of the row (default: the folder's).")] = None,
    json: JsonOption = None,
    quiet: QuietOption = False,
) -> None:
    """Score saved masks of any program (PNG folders, .npy/.npz volumes, what MoSeg, Raptor, RigidMask and EM write).

    Files are matched to the frames by their names. Where no file has a frame's name, they are taken in order, one for
    each frame, or else by their number from 0, and a note says so. Every frame with ground truth needs a mask.

    Examples
    --------
    moseg score --dataset davis16 --root DAVIS --predictions results/480p
    moseg score --dataset davis16 --predictions masks --name mine --json mine.json
    """
    from moseg.workflows.api.score import run_score
    from moseg.workflows.cli.tables import print_report

    print_report(run_score(predictions, data.choice(), format, name, json, quiet))
