"""Dense optical flow of a frame pair."""

from moseg_tasks.flow.dis import estimate_flow
from schemas.parameters import FlowParams
from workflows.stages.task import Output, Task


def _run_dis(params, inputs, rng):
    image0, image1 = (inputs[role].cached("image") for role in ("frame0", "frame1"))
    return Output({"flow": estimate_flow(image0, image1, FlowParams(**params))})


DIS = Task("flow", "dis", version=1, run=_run_dis)
