"""Coherence: deviations from the motion of what is salient, accumulated along the flow like saliency."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.accumulation import CARRIED, carried_row, memory_over, pass_direction, pass_flows
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.half_floats import to_float32
    from moseg.tasks.saliency import accumulate

    direction, order = pass_direction(params["from"])
    frames, misfits = inputs.all("saliency")[order], inputs["own_motion"].array("misfit")[order]
    accumulated = accumulate(
        (to_float32(misfit) for misfit in misfits),
        pass_flows(frames, direction),
        [params["memory"]] * len(frames),
        carried_row(inputs),
    )
    return Output({"misfit": np.ascontiguousarray(accumulated[order]), CARRIED: accumulated[-1]})


def _params(config: PipelineConfig, origin: str, gap: int) -> dict:
    return {"from": origin, "memory": memory_over(config.accumulation.memory, gap)}


ALONG_FLOW = Task("coherence", "along-flow", version=3, run=_run, params=_params, is_cue=True)

STAGE = Stage(
    name="coherence",
    about="deviation from the motion of what is salient, accumulated along the flow through a section",
    inputs={
        "saliency": "saliency of the section's frames",
        "own_motion": "deviations of their pixels",
        "carried": "the same pass in the section before",
    },
    arrays={
        "misfit": layout("float16", "frame y x", "log(1 + squared deviation in spreads)", step=1 / 64),
        CARRIED: layout("float16", "y x", "the deviation in the pass's last frame"),
    },
    tasks=(ALONG_FLOW,),
)
