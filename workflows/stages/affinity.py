"""Motion affinity between the objects of a sequence, and their support as static, under one motion model."""

import numpy as np

from moseg_tasks.affinity import estimate_affinity, static_support
from schemas.parameters import AffinityParams
from workflows.stages.task import Output, Task


def _runner(method: str):
    def run(params, inputs, rng):
        affinity_params = AffinityParams(method=method, **params["affinity"])
        sections = inputs.all("residuals")
        residuals = np.concatenate([section.array("residual") for section in sections])
        energy = np.concatenate([section.array("energy") for section in sections]) if params["is_flow"] else None
        return Output(
            {
                "affinity": estimate_affinity(residuals, affinity_params, energy),
                "static_support": static_support(residuals, affinity_params, energy),
            }
        )

    return run


RESIDUAL_SIZE = Task("affinity", "residual", version=2, run=_runner("residual"))
ORDERED_RESIDUAL_KERNEL = Task("affinity", "ork", version=2, run=_runner("ork"))
