"""Kernel: affinity of a clip's trajectories by the hypotheses of one point model that they prefer."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import KernelParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.trajectories import trajectory_kernel

    kernel_params = KernelParams.of_recipe(params["kernel"])
    draws = np.split(inputs["residuals"].array("residual"), params["num_draws"], axis=1)
    return Output({"kernel": np.stack([trajectory_kernel(residual, kernel_params) for residual in draws])})


def _params(config: PipelineConfig) -> dict:
    return {"num_draws": config.hypotheses.num_draws, "kernel": config.kernel.model_dump(mode="json")}


ORDERED_RESIDUALS = Task("kernel", "ordered-residuals", version=1, run=_run, params=_params)

STAGE = Stage(
    name="kernel",
    about="affinity of a clip's trajectories under one point model",
    inputs={"residuals": "of the model's hypotheses"},
    arrays={"kernel": layout("float32", "draw track track")},
    tasks=(ORDERED_RESIDUALS,),
)
