"""Motion memory: odds of motion, averaged along the flow over many frames, section by section in two passes."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ForegroundParams, MotionMemoryParams
from moseg.workflows.stages.accumulation import (
    CARRIED,
    EVIDENCE_PARAMS,
    SALIENT,
    carried_row,
    mean_of_passes,
    memory_over,
    pass_direction,
    pass_flows,
)
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.half_floats import to_float32
    from moseg.tasks.saliency import accumulate, motion_odds

    memory = MotionMemoryParams.of_recipe(params["motion_memory"])
    foreground = ForegroundParams.of_recipe({name: params[name] for name in EVIDENCE_PARAMS})
    direction, order = pass_direction(params["from"])
    seen = mean_of_passes(inputs, "accumulation", "maps", (SALIENT,), order)
    consistency = inputs["consistency"].array("consistency")[order]
    remembered = accumulate(
        (motion_odds(saliency, memory, foreground) for (saliency,) in seen),
        pass_flows(inputs.all("saliency")[order], direction),
        (np.float32(memory.memory) * to_float32(agreement[direction]) for agreement in consistency),
        carried_row(inputs),
    )
    return Output({"odds": np.ascontiguousarray(remembered[order]), CARRIED: remembered[-1]})


def _params(config: PipelineConfig, origin: str, gap: int) -> dict:
    read = config.motion_memory.model_dump(mode="json")
    return {
        "from": origin,
        **config.foreground.model_dump(mode="json", include=EVIDENCE_PARAMS),
        "motion_memory": {**read, "memory": memory_over(read["memory"], gap)},
    }


ALONG_FLOW = Task("motion_memory", "along-flow", version=2, run=_run, params=_params, is_cue=True)

STAGE = Stage(
    name="motion_memory",
    about="odds of motion remembered along the flow through a section",
    inputs={
        "saliency": "saliency of the section's frames",
        "consistency": "of their flows",
        "accumulation_past": "saliency accumulated from the past",
        "accumulation_future": "saliency accumulated from the future",
        "carried": "the same pass in the section before",
    },
    arrays={
        "odds": layout("float16", "frame y x", "odds of motion"),
        CARRIED: layout("float16", "y x", "the odds in the pass's last frame"),
    },
    tasks=(ALONG_FLOW,),
)
