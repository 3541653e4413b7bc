"""Flow residual: mean squared difference of each object's flow from each object's flow model."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.motion_models import flow_energy, residuals_from_moments

    moments, theta, valid = (inputs["fits"].array(name) for name in ("moments", "theta", "valid"))
    residual = np.stack([residuals_from_moments(*pair) for pair in zip(moments, theta, valid, strict=True)])
    return Output({"residual": residual, "energy": np.stack([flow_energy(pair) for pair in moments])})


MEAN_SQUARED_ERROR = Task("flow_residual", "mean-squared-error", version=1, run=_run)

STAGE = Stage(
    name="flow_residual",
    about="residuals of objects under each other's flow models in a section's frame pairs",
    inputs={"fits": "flow models of the section"},
    arrays={
        "residual": layout("float64", "section_pair model_object data_object", "(px/frame)^2"),
        "energy": layout("float64", "section_pair object", "(px/frame)^2"),
    },
    tasks=(MEAN_SQUARED_ERROR,),
)
