"""Object areas: the largest share of a frame that each object of a section covers."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.corrections.areas import largest_areas

    masks = inputs["proposals"].cached("masks")[: params["num_frames"]]
    return Output({"areas": largest_areas(masks)})


def _params(config: PipelineConfig, num_frames: int) -> dict:
    return {"num_frames": num_frames}


LARGEST = Task("object_areas", "largest", version=1, run=_run, params=_params)

STAGE = Stage(
    name="object_areas",
    about="how large each object of a section becomes",
    inputs={"proposals": "objects of the section"},
    arrays={"areas": layout("float64", "object", "largest share of a frame that the object covers, 0..1")},
    tasks=(LARGEST,),
)
