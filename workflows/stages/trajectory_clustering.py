"""Trajectory clustering: motion groups of a clip's trajectories from the kernels of one or several point models."""

from collections.abc import Sequence

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ClipSectionParams, TrajectoryClusteringParams
from moseg.schemas.parameters.clustering import COUNT_READS
from moseg.workflows.stages.hypotheses import codes_name, points_of, read_hypotheses
from moseg.workflows.stages.model_codes import model_params, point_model_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.trajectories import ModelKernels, group_clip

    views = []
    for model, drawn, affinity in zip(params["models"], inputs.all("hypotheses"), inputs.all("kernels"), strict=True):
        kernels = affinity.array("kernel")
        codes = drawn.find_kept(codes_name(inputs["trajectories"], kernels.shape[1]))
        views.append(ModelKernels(point_model_of(model), read_hypotheses(drawn), kernels, codes))
    clustering_params = TrajectoryClusteringParams.of_recipe(params["clustering"])
    section_params = ClipSectionParams.of_recipe(params["sections"])
    is_stray = inputs["trajectories"].cached("stray")
    parts = clustering_params, section_params, params["window"]
    found = group_clip(*points_of(inputs), is_stray, views, params["num_motions"], *parts, rng)
    arrays = {name: getattr(found.clustering, name) for name in ("embedding", "eigenvalues", "costs", "cuts", "codes")}
    attributes = {
        "num_motions": int(found.clustering.num_motions),
        "num_outliers": found.num_outliers,
        "objective": [float(value) for value in found.clustering.objective],
    }
    return Output({"motion": found.motion, **arrays}, attributes)


def clustering_method(config: PipelineConfig, num_views: int) -> str:
    """Return the method for so many views; for one, spectral clustering of its kernel, as published."""
    return config.trajectory_clustering.method if num_views > 1 else "sum"


def _params(config: PipelineConfig, models: Sequence[str], num_motions: int | None) -> dict:
    """Return the parameters that a clustering of these models reads; `num_motions` is None if it has to be found."""
    method = clustering_method(config, len(models))
    read = read_params(config.trajectory_clustering, method, is_auto=num_motions is None)
    codes = [model_params("point", model) for model in models]
    sections = config.clip_sections.model_dump(mode="json")
    return {
        "num_motions": num_motions,
        "clustering": read,
        "sections": sections,
        "models": codes,
        "window": config.kernel.window,
    }


def read_params(params: TrajectoryClusteringParams, method: str, is_auto: bool) -> dict:
    """Return the parameters that a clustering by `method` reads, with the number of motions found or given."""
    unread = set() if is_auto else {"most_motions", "auto"}
    if not is_auto and method != "energy":
        unread.add("separate")
    if not params.separate or "separate" in unread:
        unread.add("separation")
    counts = COUNT_READS.get(params.auto, frozenset()) - {"most_motions"} if is_auto else frozenset()
    if params.auto == "stability":
        # The draws of hypotheses serve as resamples.
        counts &= {"least_agreement"}
    if method != "coregularised":
        unread |= {"co_regularisation", "num_iterations", "tolerance"}
    if method != "energy":
        unread |= {
            "pieces",
            "outliers",
            "trust_agreement",
            "num_refined",
            "num_refinements",
            "num_split",
            "small_pieces",
        }
    if not params.num_refined:
        unread.add("trust_agreement")
    if method != "energy" or is_auto or not params.num_refined:
        unread.add("num_more")
    if method != "energy" or not is_auto or params.auto != "energy":
        unread.add("count_margin")
    if not is_auto or params.auto != "energy":
        unread.add("min_tracks")
    read = params.model_copy(update={"method": method}).model_dump(mode="json", exclude=unread | {"count"})
    if counts:
        read["count"] = params.count.model_dump(mode="json", include=counts)
    return read


MOTION_GROUPS = Task("trajectory_clustering", "motion-groups", version=11, run=_run, params=_params, is_brief=True)

STAGE = Stage(
    name="trajectory_clustering",
    about="motion groups of a clip's trajectories",
    inputs={
        "kernels": "affinity under every point model",
        "trajectories": "points of the clip",
        "hypotheses": "of every point model",
    },
    arrays={
        "motion": layout("uint16", "track", "motion group"),
        "embedding": layout("float64", "landmark coordinate"),
        "eigenvalues": layout("float64", "view eigenvalue"),
        "costs": layout("float64", "num_motions", "0..1, from one motion on"),
        "cuts": layout("float64", "num_motions", "from one motion on"),
        "codes": layout("float64", "num_motions", "share of one motion's, from one motion on"),
    },
    tasks=(MOTION_GROUPS,),
)
