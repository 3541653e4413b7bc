"""Affinity: similarity of the motions of a sequence's objects under one motion model, and their support as static."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import AffinityParams, ObjectHypothesisParams
from moseg.workflows.stages.object_hypotheses import CELL_PARAMS, PREFERENCE_PARAMS
from moseg.workflows.stages.stage import Backend, Choice, Stage
from moseg.workflows.stages.task import Output, Task

_MIN_STATIC_PAIRS = 2


def _runner(method: str):
    def run(params, inputs, rng):
        from moseg.tasks.affinity import estimate_affinity, static_support

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


_run_residual, _run_ork = _runner("residual"), _runner("ork")


def _preferences(params, inputs):
    """Return the affinity (K, K) of objects by the hypotheses that they prefer, the mean over models."""
    from moseg.tasks.object_hypotheses import preference_kernel, scale_by_background

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
    from moseg.tasks.object_hypotheses import geometric_mean

    size, preferences = _run_residual(params, inputs, rng).arrays, _preferences(params, inputs)
    return Output(
        {
            "affinity": geometric_mean(size["affinity"], preferences),
            "static_support": geometric_mean(size["static_support"], preferences[0]),
        }
    )


def _size_params(config: PipelineConfig, view: str) -> dict:
    """Return the parameters that an affinity from residuals under the objects' own models reads."""
    return _read_params(config, view, {"method", "ork_threshold", "ork_reading"})


def _ork_params(config: PipelineConfig, view: str) -> dict:
    # The support as static has a scale even if the affinity has none.
    return _read_params(config, view, {"method", "direction"})


def _read_params(config: PipelineConfig, view: str, unread: set[str]) -> dict:
    read = config.affinity.model_dump(mode="json", exclude=unread | _unread_of(view))
    if view == "trajs" and config.fundamental.step > 1:
        # a run of as many frames, of which fewer pairs are fitted
        read["static_pairs"] = max(config.affinity.static_pairs // config.fundamental.step, _MIN_STATIC_PAIRS)
    return {"is_flow": view != "trajs", "affinity": read}


def _hypothesis_params(config: PipelineConfig, view: str) -> dict:
    """Return the parameters that an affinity from preferences of hypotheses reads."""
    names = PREFERENCE_PARAMS | CELL_PARAMS
    if view == "trajs":
        names -= {"noise_floor"}
    read = config.object_hypotheses.model_dump(mode="json", include=names)
    return {"is_flow": view != "trajs", "hypotheses": read}


def _combined_params(config: PipelineConfig, view: str) -> dict:
    return _size_params(config, view) | _hypothesis_params(config, view)


def _unread_of(view: str) -> set[str]:
    return {"relative_flow"} if view == "trajs" else set()


RESIDUAL_SIZE = Task("affinity", "residual", version=4, run=_run_residual, params=_size_params)
ORDERED_RESIDUAL_KERNEL = Task("affinity", "ork", version=4, run=_run_ork, params=_ork_params)
MANY_HYPOTHESES = Task("affinity", "hypotheses", version=1, run=_run_hypotheses, params=_hypothesis_params)
SIZE_AND_HYPOTHESES = Task("affinity", "combined", version=3, run=_run_combined, params=_combined_params)
BY_HYPOTHESES = (MANY_HYPOTHESES.method, SIZE_AND_HYPOTHESES.method)
"""Methods that compare objects under many hypotheses of motion, alone or beside their own models."""

STAGE = Stage(
    name="affinity",
    about="affinity of a sequence's objects under one motion model",
    inputs={
        "residuals": "residuals of every section under the objects' models",
        "hypotheses": "residuals of every section under many hypotheses (hypotheses, combined)",
    },
    arrays={
        # The range is required of plug-ins. The ordered residual kernel has no scale: its values are at most
        # t (t + 1) (2 t + 1) / 6, and are normalised when they are clustered.
        "affinity": layout("float64", "object object", "NaN where unknown; object 0 is the background", within=(0, 1)),
        "static_support": layout("float64", "object", "NaN where unknown", within=(0, 1)),
    },
    tasks=(RESIDUAL_SIZE, ORDERED_RESIDUAL_KERNEL, MANY_HYPOTHESES, SIZE_AND_HYPOTHESES),
    method=lambda config: config.affinity.method,
    choices=(
        Choice(
            "affinity",
            "affinity.method",
            "--affinity",
            (
                Backend("residual", "size of residuals"),
                Backend("ork", "ordered residual kernel, as in the paper"),
                Backend("hypotheses", "ordered residuals of many hypotheses"),
                Backend("combined", "size of residuals and many hypotheses"),
            ),
        ),
    ),
)
