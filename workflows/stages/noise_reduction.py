"""Noise reduction: the points of a clip's trajectories with less noise, before anything is computed from them."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import NoiseReductionParams
from moseg.workflows.stages.hypotheses import points_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.trajectories import reduce_noise

    points, visible = points_of(inputs)
    clean = reduce_noise(points, visible, NoiseReductionParams.of_recipe(params))
    return Output({"points": clean.points, "visible": visible, "stray": clean.is_stray})


def _params(config: PipelineConfig) -> dict:
    return config.noise_reduction.model_dump(mode="json")


PROJECTION = Task("noise_reduction", "projection", version=1, run=_run, params=_params, is_cheap=True, is_brief=True)

STAGE = Stage(
    name="noise_reduction",
    about="trajectories of a clip with less noise, or as they are where it is small, and those that follow no motion",
    inputs={"trajectories": "points of the clip"},
    arrays={
        "points": layout("float64", "track frame xy", "px"),
        "visible": layout("bool", "track frame"),
        "stray": layout("bool", "track"),
    },
    tasks=(PROJECTION,),
)
