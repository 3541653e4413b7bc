"""Motion prompts: points and boxes of the moving regions of a section's first frame."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import MotionPromptParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

_PROMPTING = frozenset({"num_points", "trimmed", "margin", "min_area"})
"""Parameters that make the prompts; the others choose among the masks of a network."""


def _run(params, inputs, rng):
    from moseg.tasks.instances.motion_prompts import prompts_of_regions

    regions = inputs["regions"]
    num_regions = regions.shape("scores")[0]
    is_moving = np.array(regions.attributes.get("is_moving", [True] * num_regions), bool)
    prompts = prompts_of_regions(
        regions.rows("masks", 0, 1)[0], is_moving, MotionPromptParams.of_recipe(params["motion_prompts"])
    )
    return Output(
        {"labels": prompts.labels, "boxes": prompts.boxes, "points": prompts.points},
        {"regions": prompts.source.tolist()},
    )


def _params(config: PipelineConfig) -> dict:
    return {"motion_prompts": config.motion_prompts.model_dump(mode="json", include=_PROMPTING)}


def choice_params(config: PipelineConfig) -> dict:
    """Return the parameters by which a mask of a prompt is made and chosen."""
    return config.motion_prompts.model_dump(mode="json", exclude=_PROMPTING)


MOVING_REGIONS = Task("motion_prompts", "moving-regions", version=1, run=_run, params=_params)

STAGE = Stage(
    name="motion_prompts",
    about="points and boxes of the moving regions of a section's first frame",
    inputs={"regions": "moving regions of the section, from saliency or dense tracks"},
    arrays={
        "labels": layout("uint16", "y x", "region of the frame, 0 = background"),
        "boxes": layout("float32", "region xyxy", "px"),
        "points": layout("float32", "region point xy", "px"),
    },
    tasks=(MOVING_REGIONS,),
    method=lambda config: "moving-regions" if config.proposal_source == "motion-prompts" else None,
)
