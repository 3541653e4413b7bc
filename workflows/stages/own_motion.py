"""Own motion: deviation of each pixel of a section's frames from the motion of what is salient."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import OwnMotionParams
from moseg.workflows.stages.accumulation import CONSISTENT, EVIDENCE_PARAMS, STRICT, mean_of_passes
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.half_floats import to_float16, to_float32
    from moseg.tasks.saliency import motion_logit, own_motion_misfit, probability

    own_motion_params = OwnMotionParams.of_recipe(params["own_motion"])
    num_frames, start = params["num_frames"], params["start"]
    misfits = []
    accumulated = mean_of_passes(inputs, "accumulation", "maps", (STRICT, CONSISTENT))
    for t, (frame, maps) in enumerate(zip(inputs.all("saliency"), accumulated, strict=True), start):
        strict, reliability = maps
        moves = probability(motion_logit(strict, params["threshold"], params["sharpness"]))
        to_previous, to_next = to_float32(frame.array("residual_flows"))
        flows = (to_previous if t > 0 else None, to_next if t + 1 < num_frames else None)
        weight = moves**own_motion_params.sharpness * reliability**2
        misfits.append(to_float16(own_motion_misfit(flows, weight, own_motion_params)))
    return Output({"misfit": np.stack(misfits)})


def _params(config: PipelineConfig, start: int, num_frames: int) -> dict:
    return {
        "start": start,
        "num_frames": num_frames,
        **config.foreground.model_dump(mode="json", include=EVIDENCE_PARAMS),
        "own_motion": config.own_motion.model_dump(mode="json"),
    }


AFFINE_MISFIT = Task("own_motion", "affine", version=4, run=_run, params=_params, is_cue=True)

STAGE = Stage(
    name="own_motion",
    about="deviation of a section's pixels from the motion of what is salient",
    inputs={
        "saliency": "saliency of the section's frames",
        "accumulation_past": "saliency accumulated from the past",
        "accumulation_future": "saliency accumulated from the future",
    },
    arrays={"misfit": layout("float16", "frame y x", "log(1 + squared deviation in spreads)", step=1 / 64)},
    tasks=(AFFINE_MISFIT,),
)
