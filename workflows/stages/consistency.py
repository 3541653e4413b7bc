"""Consistency: agreement of the flows of a section's frames with those of their neighbours."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import AccumulationParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

CONSISTENCY_PARAMS = frozenset({"consistency_relative", "consistency_absolute"})
"""Parameters of the accumulation that only this stage reads."""


def _run(params, inputs, rng):
    from moseg.tasks.half_floats import to_float16, to_float32
    from moseg.tasks.saliency import flow_consistency

    flows = [to_float32(frame.array("flows")) for frame in inputs.all("saliency")]
    consistency = flow_consistency(flows, AccumulationParams.of_recipe(params["accumulation"]))
    return Output({"consistency": to_float16(consistency[params["first"] : params["last"]])})


def _params(config: PipelineConfig, first: int, last: int) -> dict:
    read = config.accumulation.model_dump(mode="json", include=CONSISTENCY_PARAMS)
    return {"first": first, "last": last, "accumulation": read}


FORWARD_BACKWARD = Task("consistency", "forward-backward", version=2, run=_run, params=_params, is_cue=True)

STAGE = Stage(
    name="consistency",
    about="agreement of the flows of a section's frames with their neighbours'",
    inputs={"saliency": "saliency of the section's frames and of one on either side"},
    arrays={"consistency": layout("float16", "frame direction y x", "0..1", step=1 / 256)},
    tasks=(FORWARD_BACKWARD,),
)
