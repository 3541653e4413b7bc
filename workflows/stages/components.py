"""Components: objects of a section on the working grid, segmented from the foreground, split and merged by motion."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ComponentParams, IdentityParams
from moseg.workflows.stages.frame_rows import maps_of, reduced_images
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def join_rows(sections, name: str, num_rows: int) -> np.ndarray:
    """Return the first `num_rows` rows of an array that continues from section to section."""
    parts = []
    for section in sections:
        parts.append(section.rows(name, 0, min(num_rows, section.shape(name)[0])))
        num_rows -= len(parts[-1])
    return np.concatenate(parts) if len(parts) > 1 else parts[0]


def _run(params, inputs, rng):
    from moseg.tasks.proposals import (
        fill_holes,
        keep_best,
        keep_parts,
        label_components,
        part_distant,
        rejoin_components,
        split_touching,
    )

    identity = IdentityParams.of_recipe(params["identity"])
    foreground = join_rows(inputs.all("foreground"), "foreground", params["num_frames"])
    component_params = ComponentParams.of_recipe(params["components"])
    labels, gap = label_components(foreground, component_params), params.get("gap", 1)
    if labels.any():
        flows, residual_flows = (maps_of(inputs.all("saliency"), name) for name in ("flows", "residual_flows"))
        labels = split_touching(labels, residual_flows, identity, gap)
        if "steps" in inputs:
            flows, residual_flows = (maps_of(inputs.all("steps"), name) for name in ("flows", "residual_flows"))
        parted = part_distant(labels, flows, identity, gap)
        part = np.where(parted > labels.max(), parted, 0)
        images = reduced_images(inputs.all("frames"), labels.shape[1:])
        labels = rejoin_components(labels, images, flows, residual_flows, identity)
    components = keep_best(foreground, labels, component_params)
    if components.labels.any():
        components = keep_parts(foreground, components, part, component_params)
    objects = components.labels
    if objects.any():
        objects = fill_holes(objects, foreground, images, flows, residual_flows, component_params)
    return Output({"labels": objects, "scores": components.scores})


def _params(config: PipelineConfig, num_frames: int, gap: int) -> dict:
    """Return the parameters of a section whose flow leads `gap` pictures farther."""
    return {
        "num_frames": num_frames,
        **({} if gap == 1 else {"gap": gap}),
        "components": config.components.model_dump(mode="json"),
        "identity": config.identity.model_dump(mode="json", exclude={"return_gap"}),
    }


SPACE_TIME = Task("components", "space-time", version=7, run=_run, params=_params)

STAGE = Stage(
    name="components",
    about="objects of a section on the working grid",
    inputs={
        "foreground": "probability to move, of every section with a frame of this one",
        "frames": "frames of the section, and those that it shares with the next",
        "saliency": "saliency of these frames",
        "steps": "the same with the flow to the frames right beside them, where these are not the ones compared",
    },
    arrays={
        "labels": layout("uint16", "frame y x", "object of the section, 0 = background"),
        "scores": layout("float64", "object"),
    },
    tasks=(SPACE_TIME,),
)
