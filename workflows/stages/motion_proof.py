"""Motion proof: how much better the observed flow explains the colours of a section's pixels than the background's."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import MotionProofParams
from moseg.workflows.stages.reduced_frame import reduced_levels
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    first, num_frames = params["first"], len(inputs.all("saliency"))
    # None before the first and after the last frame of the video.
    rows = [None] * (1 - first) + list(range(len(inputs.all("frames")))) + [None]
    return _prove(params, inputs, [(rows[t + 1], rows[t], rows[t + 2]) for t in range(num_frames)], "saliency")


def _run_repeated(params, inputs, rng):
    return _prove(params, inputs, params["rows"], "steps")


def _prove(params, inputs, rows, carrying: str) -> Output:
    """Return the proof of frames in `rows` of the inputs, with their neighbours, averaged along flows of a role."""
    from moseg.tasks.half_floats import to_float16, to_float32
    from moseg.tasks.motion_proof import average_along_flow, prove_motion

    proof_params = MotionProofParams.of_recipe(params["motion_proof"])
    cues = inputs.all("saliency")
    shape = cues[0].shape("flows")[1:3]
    images = [reduced_levels(frame, shape).astype(np.float32) for frame in inputs.all("frames")]
    proofs = []
    for cue, (own, *beside) in zip(cues, rows, strict=True):
        neighbours = tuple(None if row is None else images[row] for row in beside)
        flows, residual_flows = (to_float32(cue.array(name)) for name in ("flows", "residual_flows"))
        proofs.append(prove_motion(images[own], neighbours, flows, residual_flows, proof_params))
    carried = [to_float32(cue.array("flows")) for cue in inputs.all(carrying)]
    proof = average_along_flow(proofs, carried, proof_params.memory)
    return Output({"proof": to_float16(np.ascontiguousarray(proof))})


def _params(config: PipelineConfig, first: int) -> dict:
    return {"first": first, "motion_proof": config.motion_proof.model_dump(mode="json")}


def _repeated_params(config: PipelineConfig, rows: list[list[int | None]]) -> dict:
    """Return the parameters of frames, some repeated: the places of each and of its neighbours among those read."""
    return {"rows": rows, "motion_proof": config.motion_proof.model_dump(mode="json")}


PHOTOMETRIC = Task("motion_proof", "photometric", version=1, run=_run, params=_params)
REPEATED = Task("motion_proof", "repeated", version=1, run=_run_repeated, params=_repeated_params)

STAGE = Stage(
    name="motion_proof",
    about="photometric proof of motion of a section's pixels",
    inputs={
        "frames": "frames of the section and one on either side, or the nearest that show another picture (repeated)",
        "saliency": "saliency of the section's frames",
        "steps": "the same with the flow to the frames right beside them (repeated)",
    },
    arrays={"proof": layout("float16", "frame y x", "nats")},
    tasks=(PHOTOMETRIC, REPEATED),
)
