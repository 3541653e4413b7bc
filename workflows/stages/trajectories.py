"""Motion groups of trajectories: hypotheses of a point model, residuals, kernels, clusters, and their score."""

import math

import numpy as np

from moseg.schemas.parameters import HypothesisParams, KernelParams, TrajectoryClusteringParams
from moseg.schemas.trajectory_scores import TrajectoryScore
from moseg.tasks.metrics import clustering_error
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import (
    Hypotheses,
    View,
    cluster_trajectories,
    draw_hypotheses,
    hypothesis_residuals,
    trajectory_kernel,
)
from moseg.workflows.stages.task import Output, Task


def _points(inputs):
    return inputs["trajectories"].cached("points"), inputs["trajectories"].cached("visible")


def _run_draw(params, inputs, rng):
    hypothesis_params = HypothesisParams.of_recipe(params["hypotheses"])
    found = draw_hypotheses(*_points(inputs), POINT_MODELS[params["model"]], hypothesis_params, rng)
    shape = found.parameters.shape
    # A matrix or a tensor: the store's layout has one axis for both.
    flat = found.parameters.reshape(*shape[:2], math.prod(shape[2:]))
    return Output({"parameters": flat, "frames": found.frames}, {"shape": list(shape[2:])})


def _run_residual(params, inputs, rng):
    drawn = inputs["hypotheses"]
    flat, frames = drawn.array("parameters"), drawn.array("frames")
    hypotheses = Hypotheses(flat.reshape(*flat.shape[:2], *drawn.attributes["shape"]), frames)
    residual = hypothesis_residuals(hypotheses, *_points(inputs), POINT_MODELS[params["model"]])
    return Output({"residual": residual})


def _run_kernel(params, inputs, rng):
    kernel_params = KernelParams.of_recipe(params["kernel"])
    draws = np.split(inputs["residuals"].array("residual"), params["num_draws"], axis=1)
    return Output({"kernel": np.stack([trajectory_kernel(residual, kernel_params) for residual in draws])})


def _run_clustering(params, inputs, rng):
    kernels = [model.array("kernel") for model in inputs.all("kernels")]
    num_draws = len(kernels[0])
    residuals = [[None] * num_draws] * len(kernels)
    if "residuals" in inputs:
        residuals = [np.split(model.array("residual"), num_draws, axis=1) for model in inputs.all("residuals")]
    draws = [
        [View(kernel[draw], residual[draw]) for kernel, residual in zip(kernels, residuals, strict=True)]
        for draw in range(num_draws)
    ]
    clustering_params = TrajectoryClusteringParams.of_recipe(params["clustering"])
    result = cluster_trajectories(draws, *_points(inputs), params["num_motions"], clustering_params, rng)
    arrays = ("motion", "embedding", "eigenvalues", "costs", "cuts")
    return Output(
        {name: getattr(result, name) for name in arrays},
        {"num_motions": int(result.num_motions), "objective": [float(value) for value in result.objective]},
    )


def _run_score(params, inputs, rng):
    labels = inputs["labels"].array("labels")
    score = TrajectoryScore(
        error=clustering_error(inputs["clustering"].array("motion"), labels),
        num_motions=inputs["clustering"].attributes["num_motions"],
        num_motions_true=len(set(labels.tolist())),
    )
    return Output({}, score.model_dump())


MINIMAL_SAMPLES = Task("hypotheses", "minimal-samples", version=1, run=_run_draw)
POINT_MODEL = Task("hypothesis_residual", "point-model", version=1, run=_run_residual)
ORDERED_RESIDUALS = Task("kernel", "ordered-residuals", version=1, run=_run_kernel)
MOTION_GROUPS = Task("trajectory_clustering", "motion-groups", version=1, run=_run_clustering)
SCORE = Task("score", "trajectories", version=1, run=_run_score)
