"""Motion affinity between the objects of a sequence, and their support as static, under one motion model."""

import numpy as np

from moseg.schemas.parameters import AffinityParams, ObjectHypothesisParams
from moseg.tasks.affinity import estimate_affinity, static_support
from moseg.tasks.object_hypotheses import geometric_mean, preference_kernel, scale_by_background
from moseg.workflows.stages.task import Output, Task


def _runner(method: str):
    def run(params, inputs, rng):
        affinity_params = AffinityParams.of_recipe({"method": method, **params["affinity"]})
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


def _preferences(params, inputs):
    """Affinity (K, K) of objects by the hypotheses that they prefer, the mean over models."""
    read = ObjectHypothesisParams.of_recipe(params["hypotheses"])
    residuals = np.concatenate([section.array("residual") for section in inputs.all("hypotheses")])
    noise_floor = read.noise_floor if params["is_flow"] else 0.0
    kernels = [preference_kernel(residuals[:, model], read.window, noise_floor) for model in range(residuals.shape[1])]
    num_objects = residuals.shape[3] - read.background_rows * read.background_columns
    return scale_by_background(np.mean(kernels, axis=0), num_objects, read)


def _run_hypotheses(params, inputs, rng):
    affinity = _preferences(params, inputs)
    return Output({"affinity": affinity, "static_support": affinity[0]})


def _run_combined(params, inputs, rng):
    size, preferences = _BY_SIZE(params, inputs, rng).arrays, _preferences(params, inputs)
    return Output(
        {
            "affinity": geometric_mean(size["affinity"], preferences),
            "static_support": geometric_mean(size["static_support"], preferences[0]),
        }
    )


_BY_SIZE = _runner("residual")
RESIDUAL_SIZE = Task("affinity", "residual", version=2, run=_runner("residual"))
ORDERED_RESIDUAL_KERNEL = Task("affinity", "ork", version=2, run=_runner("ork"))
MANY_HYPOTHESES = Task("affinity", "hypotheses", version=1, run=_run_hypotheses)
SIZE_AND_HYPOTHESES = Task("affinity", "combined", version=1, run=_run_combined)
