"""Fundamental: a fundamental matrix per object and frame pair of a section (the trajectory model, section 3.3).

The pairs of a section are stacked in one artifact: fitting a pair takes less time than storing it alone would.
"""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import FundamentalParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def pair_tracks(params, inputs):
    """Yield, for each pair, the points visible in both frames: xy in each, and the object of the sequence of each."""
    points, visible = inputs["tracks"].cached("points"), inputs["tracks"].cached("visible")
    identity = inputs["linking"].cached("identity")[params["section"]]
    owner = identity[inputs["tracks"].cached("object")]
    for frame0 in range(0, params["num_pairs"], params.get("step", 1)):
        frame1 = frame0 + params["gap"]
        seen = visible[:, frame0] & visible[:, frame1]
        yield points[seen, frame0].astype(np.float64), points[seen, frame1].astype(np.float64), owner[seen]


def _run(params, inputs, rng):
    from moseg.tasks.geometry import FundamentalFits, fit_fundamentals

    num_objects = inputs["linking"].attributes["num_objects"]
    fundamental_params, shape = FundamentalParams.of_recipe(params["fundamental"]), tuple(params["shape"])
    fits = [
        fit_fundamentals(*pair, num_objects, fundamental_params, rng, shape) for pair in pair_tracks(params, inputs)
    ]
    return Output({name: np.stack([getattr(fit, name) for fit in fits]) for name in FundamentalFits._fields})


def _params(config: PipelineConfig, section: int, num_pairs: int, gap: int, shape: tuple[int, int]) -> dict:
    read = config.fundamental.model_dump(mode="json", exclude={"gap", "step", "statistic"})
    return {**pair_params(config, section, num_pairs, gap), "shape": list(shape), "fundamental": read}


def pair_params(config: PipelineConfig, section: int, num_pairs: int, gap: int) -> dict:
    """Return the parameters that `pair_tracks` reads."""
    step = config.fundamental.step
    params = {"section": section, "num_pairs": num_pairs, "gap": gap}
    return params if step == 1 else {**params, "step": step}


RANSAC_FIT = Task("fundamental", "ransac", version=1, run=_run, params=_params)

STAGE = Stage(
    name="fundamental",
    about="fundamental matrices of a section's frame pairs",
    inputs={"tracks": "tracks of the section", "linking": "identities of its objects"},
    arrays={
        "F": layout("float64", "section_pair object row column"),
        "valid": layout("bool", "section_pair object"),
        "counts": layout("int32", "section_pair object points_inliers_homography", "points"),
        "reason": layout("uint8", "section_pair object", "why the fit is degenerate"),
        "kind": layout("uint8", "section_pair object", "0 none, 1 fundamental matrix, 2 homography"),
    },
    tasks=(RANSAC_FIT,),
)
