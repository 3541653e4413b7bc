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
    return Output({"points": reduce_noise(points, visible, NoiseReductionParams.of_recipe(params)), "visible": visible})


def _params(config: PipelineConfig) -> dict:
    return config.noise_reduction.model_dump(mode="json")


PROJECTION = Task("noise_reduction", "projection", version=1, run=_run, params=_params, is_cheap=True)

STAGE = Stage(
    name="noise_reduction",
    about="trajectories of a clip with less noise; as they are where noise is small",
    inputs={"trajectories": "points of the clip"},
    arrays={
        "points": layout("float64", "track frame xy", "px"),
        "visible": layout("bool", "track frame"),
    },
    tasks=(PROJECTION,),
)
