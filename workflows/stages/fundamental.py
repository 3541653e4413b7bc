"""The trajectory model of a frame pair: a fundamental matrix per object, and every object's residual under it."""

import numpy as np

from moseg_tasks.geometry import FundamentalFits, fit_fundamentals, fundamental_residuals
from schemas.parameters import FundamentalParams
from workflows.stages.task import Output, Task


def _pair_points(params, inputs):
    """Points visible in both frames of the pair: xy in each, and the object of the sequence that each lies on."""
    frame0, frame1 = params["offset"], params["offset"] + params["gap"]
    points, visible = inputs["tracks"].cached("points"), inputs["tracks"].cached("visible")
    identity = inputs["linking"].cached("identity")[params["section"]]
    seen = visible[:, frame0] & visible[:, frame1]
    points0, points1 = points[seen, frame0].astype(np.float64), points[seen, frame1].astype(np.float64)
    return points0, points1, identity[inputs["tracks"].cached("object")[seen]]


def _run_fit(params, inputs, rng):
    points0, points1, owner = _pair_points(params, inputs)
    fits = fit_fundamentals(
        points0,
        points1,
        owner,
        inputs["linking"].attributes["num_objects"],
        FundamentalParams(**params["fundamental"]),
        rng,
        tuple(params["shape"]),
    )
    return Output(fits._asdict())


def _run_residual(params, inputs, rng):
    points0, points1, owner = _pair_points(params, inputs)
    fits = FundamentalFits(**{name: inputs["fits"].array(name) for name in FundamentalFits._fields})
    residual = fundamental_residuals(fits, points0, points1, owner, FundamentalParams(**params["fundamental"]))
    return Output({"residual": residual})


RANSAC_FIT = Task("fundamental", "ransac", version=1, run=_run_fit)
SAMPSON_RESIDUAL = Task("fundamental_residual", "sampson", version=1, run=_run_residual)
