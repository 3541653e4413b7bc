"""Hypothesis residual: distance of every trajectory of a clip to every hypothesis of one point model."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.hypotheses import points_of
from moseg.workflows.stages.model_codes import model_params, point_model_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.trajectories import Hypotheses, hypothesis_residuals

    drawn = inputs["hypotheses"]
    flat, frames = drawn.array("parameters"), drawn.array("frames")
    hypotheses = Hypotheses(flat.reshape(*flat.shape[:2], *drawn.attributes["shape"]), frames)
    residual = hypothesis_residuals(hypotheses, *points_of(inputs), point_model_of(params))
    return Output({"residual": residual})


def _params(config: PipelineConfig, model: str) -> dict:
    return model_params("point", model)


POINT_MODEL = Task("hypothesis_residual", "point-model", version=1, run=_run, params=_params)

STAGE = Stage(
    name="hypothesis_residual",
    about="residuals of a clip's trajectories under the hypotheses of one point model",
    inputs={"hypotheses": "of the model", "trajectories": "points of the clip"},
    arrays={"residual": layout("float16", "frame_set hypothesis track", "px, NaN where not seen")},
    tasks=(POINT_MODEL,),
)
