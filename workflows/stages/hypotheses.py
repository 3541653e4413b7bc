"""Residuals of a section's objects, and of its background's cells, under many hypotheses of motion a frame pair.

The pairs of a section are stacked in one artifact. Nodes are the sequence's objects, the background first, which as a
whole takes no part, then the background's cells.
"""

import numpy as np

from moseg.schemas.parameters import FlowModelParams, ObjectHypothesisParams
from moseg.tasks.motion_models import FLOW_MODELS
from moseg.tasks.object_hypotheses import (
    background_cells,
    flow_patch_residuals,
    split_background,
    track_sample_residuals,
)
from moseg.workflows.stages.flow_models import read_pairs
from moseg.workflows.stages.fundamental import pair_tracks
from moseg.workflows.stages.task import Output, Task


def _run_flow(params, inputs, rng):
    model, flow_params = FLOW_MODELS[params["model"]], FlowModelParams.of_recipe(params["flow_model"])
    drawn = ObjectHypothesisParams.of_recipe(params["hypotheses"])
    num_objects = inputs["linking"].attributes["num_objects"]
    num_nodes = num_objects + drawn.background_rows * drawn.background_columns
    residuals = []
    for flow, depth, owner in read_pairs(params, inputs, flow_params):
        nodes = split_background(owner, background_cells(owner.shape, drawn), num_objects)
        residuals.append(flow_patch_residuals(flow, depth, nodes, num_nodes, model, flow_params, drawn, rng))
    return Output({"residual": np.stack(residuals)[:, None].astype(np.float32)})


def _run_tracks(params, inputs, rng):
    drawn = ObjectHypothesisParams.of_recipe(params["hypotheses"])
    num_objects = inputs["linking"].attributes["num_objects"]
    num_nodes = num_objects + drawn.background_rows * drawn.background_columns
    cells = background_cells(tuple(params["shape"]), drawn)
    residuals = []
    for points0, points1, owner in pair_tracks(params, inputs):
        x, y = np.clip(np.rint(points0).astype(np.int64), 0, np.array(cells.shape)[::-1] - 1).T
        nodes = split_background(owner, cells[y, x], num_objects)
        residuals.append(track_sample_residuals(points0, points1, nodes, num_nodes, params["min_points"], drawn, rng))
    return Output({"residual": np.stack(residuals).astype(np.float32)})


FLOW_PATCHES = Task("object_hypotheses", "flow-patches", version=1, run=_run_flow)
TRACK_SAMPLES = Task("object_hypotheses", "track-samples", version=1, run=_run_tracks)
