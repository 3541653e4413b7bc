"""Object hypotheses: residuals of a section's objects, and of its background's cells, under many drawn motions.

The pairs of a section are stacked in one artifact. Its nodes are the objects of the sequence, of which the
first, the whole background, is not used, and then the cells of the background.
"""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import FlowModelParams, ObjectHypothesisParams
from moseg.workflows.stages.flow_model import read_pairs
from moseg.workflows.stages.fundamental import pair_tracks
from moseg.workflows.stages.model_codes import flow_model_of, model_params
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

CELL_PARAMS = frozenset({"background_rows", "background_columns"})
PATCH_PARAMS = frozenset({"block", "min_patch", "elongation"})
PREFERENCE_PARAMS = frozenset({"window", "noise_floor", "scale_quantile"})
"""Parameters that only the affinity reads."""


def _run_flow(params, inputs, rng):
    from moseg.tasks.object_hypotheses import background_cells, flow_patch_residuals, split_background

    model, flow_params = flow_model_of(params), FlowModelParams.of_recipe(params["flow_model"])
    drawn = ObjectHypothesisParams.of_recipe(params["hypotheses"])
    num_objects = inputs["linking"].attributes["num_objects"]
    num_nodes = num_objects + drawn.background_rows * drawn.background_columns
    residuals = []
    for flow, depth, owner in read_pairs(params, inputs, flow_params):
        nodes = split_background(owner, background_cells(owner.shape, drawn), num_objects)
        residuals.append(flow_patch_residuals(flow, depth, nodes, num_nodes, model, flow_params, drawn, rng))
    return Output({"residual": np.stack(residuals)[:, None].astype(np.float32)})


def _run_tracks(params, inputs, rng):
    from moseg.tasks.object_hypotheses import background_cells, split_background, track_sample_residuals

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


def _flow_params(config: PipelineConfig, section: int, model: str) -> dict:
    names = PATCH_PARAMS | CELL_PARAMS | {"num_hypotheses"}
    return {
        "section": section,
        **model_params("flow", model),
        "flow_model": config.flow_model.model_dump(mode="json"),
        "hypotheses": config.object_hypotheses.model_dump(mode="json", include=names),
    }


def _track_params(config: PipelineConfig, section: int, num_pairs: int, gap: int, shape: tuple[int, int]) -> dict:
    names = CELL_PARAMS | {"num_hypotheses"}
    return {
        "section": section,
        "num_pairs": num_pairs,
        "gap": gap,
        "shape": list(shape),
        "min_points": config.fundamental.min_points,
        "hypotheses": config.object_hypotheses.model_dump(mode="json", include=names),
    }


FLOW_PATCHES = Task("object_hypotheses", "flow-patches", version=1, run=_run_flow, params=_flow_params)
TRACK_SAMPLES = Task("object_hypotheses", "track-samples", version=1, run=_run_tracks, params=_track_params)

STAGE = Stage(
    name="object_hypotheses",
    about="residuals of objects and cells under many hypotheses of motion in a section's frame pairs",
    inputs={
        "tracks": "tracks of the section (track-samples)",
        "flow": "flow of every pair (flow-patches)",
        "depth": "inverse depth of the first frame of every pair, for models that read it (flow-patches)",
        "proposals": "objects of the section (flow-patches)",
        "linking": "identities of its objects",
    },
    arrays={
        "residual": layout(
            "float32", "section_pair model hypothesis node", "px^2; objects, then cells of the background"
        )
    },
    tasks=(FLOW_PATCHES, TRACK_SAMPLES),
)
