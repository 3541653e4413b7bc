"""Motion proof: how much better the observed flow explains the colours of a section's pixels than the background's."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import MotionProofParams
from moseg.workflows.stages.reduced_frame import reduced_levels
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.half_floats import to_float16, to_float32
    from moseg.tasks.motion_proof import average_along_flow, prove_motion

    proof_params = MotionProofParams.of_recipe(params["motion_proof"])
    cues = inputs.all("saliency")
    flows = [to_float32(cue.array("flows")) for cue in cues]
    shape = flows[0].shape[1:3]
    images = [reduced_levels(frame, shape).astype(np.float32) for frame in inputs.all("frames")]
    # None before the first and after the last frame of the video.
    seen = [None] * (1 - params["first"]) + images + [None]
    proofs = []
    for t, cue in enumerate(cues):
        residual_flows = to_float32(cue.array("residual_flows"))
        proofs.append(prove_motion(seen[t + 1], (seen[t], seen[t + 2]), flows[t], residual_flows, proof_params))
    return Output({"proof": to_float16(np.ascontiguousarray(average_along_flow(proofs, flows, proof_params.memory)))})


def _params(config: PipelineConfig, first: int) -> dict:
    return {"first": first, "motion_proof": config.motion_proof.model_dump(mode="json")}


PHOTOMETRIC = Task("motion_proof", "photometric", version=1, run=_run, params=_params)

STAGE = Stage(
    name="motion_proof",
    about="photometric proof of motion of a section's pixels",
    inputs={
        "frames": "frames of the section and one on either side",
        "saliency": "saliency of the section's frames",
    },
    arrays={"proof": layout("float16", "frame y x", "nats")},
    tasks=(PHOTOMETRIC,),
)
