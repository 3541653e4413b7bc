"""Fundamental residual: Sampson distance of each object's tracks to each object's fundamental matrix."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import FundamentalParams
from moseg.workflows.stages.fundamental import pair_params, pair_tracks
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.geometry import FundamentalFits, fundamental_residuals

    fundamental_params = FundamentalParams.of_recipe(params["fundamental"])
    stacked = [inputs["fits"].array(name) for name in FundamentalFits._fields]
    residuals = [
        fundamental_residuals(FundamentalFits(*fit), *pair, fundamental_params)
        for fit, pair in zip(zip(*stacked, strict=True), pair_tracks(params, inputs), strict=True)
    ]
    return Output({"residual": np.stack(residuals)})


def _params(config: PipelineConfig, section: int, num_pairs: int, gap: int) -> dict:
    read = config.fundamental.model_dump(mode="json", include={"statistic", "min_points"})
    return {**pair_params(config, section, num_pairs, gap), "fundamental": read}


SAMPSON_RESIDUAL = Task("fundamental_residual", "sampson", version=1, run=_run, params=_params)

STAGE = Stage(
    name="fundamental_residual",
    about="residuals of objects under each other's fundamental matrices in a section's frame pairs",
    inputs={
        "fits": "fundamental matrices of the section",
        "tracks": "tracks of the section",
        "linking": "identities of its objects",
    },
    arrays={"residual": layout("float64", "section_pair model_object data_object", "px^2")},
    tasks=(SAMPSON_RESIDUAL,),
)
