"""Dense optical flow of a frame pair."""

import numpy as np

from moseg.schemas.parameters import FlowParams, RaftParams
from moseg.tasks.flow.dis import estimate_flow
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.task import Output, Task


def _run_dis(params, inputs, rng):
    image0, image1 = (inputs[role].cached("image") for role in ("frame0", "frame1"))
    return Output({"flow": estimate_flow(image0, image1, FlowParams.of_recipe(params))})


def _run_raft(params, inputs):
    from moseg.tasks.flow.raft import estimate_raft_flow
    from moseg.tasks.networks.raft import build_raft

    images0, images1 = (np.stack([each[role].cached("image") for each in inputs]) for role in ("frame0", "frame1"))
    with open_network(build_raft, inputs[0]["weights"]) as network:
        flows = estimate_raft_flow(network, images0, images1, RaftParams.of_recipe(params["raft"]))
    return [Output({"flow": flow}, made_on()) for flow in flows]


DIS = Task("flow", "dis", version=1, run=_run_dis, is_brief=True)
RAFT = Task("flow", "raft", version=1, run_together=_run_raft)
