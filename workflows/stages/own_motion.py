"""How badly each pixel of a section's frames follows the motion of what is salient."""

import numpy as np

from moseg.schemas.parameters import OwnMotionParams
from moseg.tasks.half_floats import to_float16, to_float32
from moseg.tasks.saliency import motion_logit, own_motion_misfit, probability
from moseg.workflows.stages.accumulation import mean_of_passes
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    own_motion_params = OwnMotionParams.of_recipe(params["own_motion"])
    num_frames, start = params["num_frames"], params["start"]
    misfits = []
    accumulated = mean_of_passes(inputs, "accumulation", "maps")
    for t, (frame, maps) in enumerate(zip(inputs.all("saliency"), accumulated, strict=True), start):
        strict, reliability = maps[..., 0], maps[..., 2]
        moves = probability(motion_logit(strict, params["threshold"], params["sharpness"]))
        to_previous, to_next = to_float32(frame.array("residual_flows"))
        flows = (to_previous if t > 0 else None, to_next if t + 1 < num_frames else None)
        weight = moves**own_motion_params.sharpness * reliability**2
        misfits.append(to_float16(own_motion_misfit(flows, weight, own_motion_params)))
    return Output({"misfit": np.stack(misfits)})


AFFINE_MISFIT = Task("own_motion", "affine", version=1, run=_run)
