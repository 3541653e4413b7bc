"""The trajectory model of a section's frame pairs: a fundamental matrix per object, and every object's residual.

The pairs of a section are stacked in one artifact: fitting a pair takes less time than storing it alone would.
"""

import numpy as np

from moseg.schemas.parameters import FundamentalParams
from moseg.tasks.geometry import FundamentalFits, fit_fundamentals, fundamental_residuals
from moseg.workflows.stages.task import Output, Task


def pair_tracks(params, inputs):
    """For each pair the points visible in both frames: xy in each, and the object of the sequence that each lies on."""
    points, visible = inputs["tracks"].cached("points"), inputs["tracks"].cached("visible")
    identity = inputs["linking"].cached("identity")[params["section"]]
    owner = identity[inputs["tracks"].cached("object")]
    for frame0 in range(params["num_pairs"]):
        frame1 = frame0 + params["gap"]
        seen = visible[:, frame0] & visible[:, frame1]
        yield points[seen, frame0].astype(np.float64), points[seen, frame1].astype(np.float64), owner[seen]


def _run_fit(params, inputs, rng):
    num_objects = inputs["linking"].attributes["num_objects"]
    fundamental_params, shape = FundamentalParams.of_recipe(params["fundamental"]), tuple(params["shape"])
    fits = [
        fit_fundamentals(*pair, num_objects, fundamental_params, rng, shape) for pair in pair_tracks(params, inputs)
    ]
    return Output({name: np.stack([getattr(fit, name) for fit in fits]) for name in FundamentalFits._fields})


def _run_residual(params, inputs, rng):
    fundamental_params = FundamentalParams.of_recipe(params["fundamental"])
    stacked = [inputs["fits"].array(name) for name in FundamentalFits._fields]
    residuals = [
        fundamental_residuals(FundamentalFits(*fit), *pair, fundamental_params)
        for fit, pair in zip(zip(*stacked, strict=True), pair_tracks(params, inputs), strict=True)
    ]
    return Output({"residual": np.stack(residuals)})


RANSAC_FIT = Task("fundamental", "ransac", version=1, run=_run_fit)
SAMPSON_RESIDUAL = Task("fundamental_residual", "sampson", version=1, run=_run_residual)
