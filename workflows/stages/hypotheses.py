"""Hypotheses: motions of one point model, each fitted to a minimal sample of a clip's trajectories."""

import math

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import HypothesisParams
from moseg.workflows.stages.inputs import ArtifactView, Inputs
from moseg.workflows.stages.model_codes import model_params, point_model_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def points_of(inputs: Inputs) -> tuple[np.ndarray, np.ndarray]:
    """Return the points float64 (track, frame, xy), px, of a clip, and bool (track, frame) where they are visible."""
    return inputs["trajectories"].cached("points"), inputs["trajectories"].cached("visible")


def codes_name(trajectories: ArtifactView, num_landmarks: int) -> str:
    """Return the name of the codes of landmarks' residuals, which are kept with the hypotheses (`keep`)."""
    return f"codes of {num_landmarks} landmarks of {trajectories.ref}"


def read_hypotheses(drawn: ArtifactView):
    """Return the `Hypotheses` of one point model from their artifact."""
    from moseg.tasks.trajectories import Hypotheses

    flat, frames = drawn.array("parameters"), drawn.array("frames")
    return Hypotheses(flat.reshape(*flat.shape[:2], *drawn.attributes["shape"]), frames)


def _run(params, inputs, rng):
    from moseg.tasks.trajectories import draw_hypotheses

    hypothesis_params = HypothesisParams.of_recipe(params["hypotheses"])
    points, visible = points_of(inputs)
    follows = ~inputs["trajectories"].cached("stray")
    found = draw_hypotheses(points[follows], visible[follows], point_model_of(params), hypothesis_params, rng)
    shape = found.parameters.shape
    # A parameter is a matrix or a tensor; the layout in the store has one axis for both.
    flat = found.parameters.reshape(*shape[:2], math.prod(shape[2:]))
    return Output({"parameters": flat, "frames": found.frames}, {"shape": list(shape[2:])})


def _params(config: PipelineConfig, model: str) -> dict:
    return {**model_params("point", model), "hypotheses": config.hypotheses.model_dump(mode="json")}


MINIMAL_SAMPLES = Task("hypotheses", "minimal-samples", version=4, run=_run, params=_params, is_brief=True)

STAGE = Stage(
    name="hypotheses",
    about="hypotheses of one point model on a clip",
    inputs={"trajectories": "points of the clip"},
    arrays={
        "parameters": layout("float64", "frame_set hypothesis parameter"),
        "frames": layout("int32", "frame_set frame"),
    },
    tasks=(MINIMAL_SAMPLES,),
)
