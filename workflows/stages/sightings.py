"""Sightings: how a section's objects look and move where they begin and end, to know them again after a gap."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import IdentityParams
from moseg.workflows.stages.frame_rows import maps_of, reduced_images
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

SIGHTING_PARAMS = frozenset({"rejoin_seen", "rejoin_memory"})
"""Parameters of the identities that describe an object."""


def _run(params, inputs, rng):
    from moseg.tasks.proposals.returning import see_objects

    labels = inputs["components"].array("labels")
    shape = labels.shape[1:]
    images = reduced_images(inputs.all("frames"), shape)
    flows, residual_flows = (maps_of(inputs.all("saliency"), name) for name in ("flows", "residual_flows"))
    seen = see_objects(labels, images, flows, residual_flows, IdentityParams.of_recipe(params["identity"]))
    return Output(seen._asdict(), {"frame_area": int(np.prod(shape))})


def _params(config: PipelineConfig) -> dict:
    return {"identity": config.identity.model_dump(mode="json", include=SIGHTING_PARAMS)}


BOTH_ENDS = Task("sightings", "both-ends", version=1, run=_run, params=_params)

STAGE = Stage(
    name="sightings",
    about="appearance and motion of a section's objects where they begin and end",
    inputs={
        "components": "objects on the working grid",
        "frames": "frames of the section, and those that it shares with the next",
        "saliency": "saliency of these frames",
    },
    arrays={
        "frames": layout("int32", "object end frame", "first or last, and next fully visible one; -1 unseen"),
        "places": layout("float32", "object end number", "centre xy, velocity xy, area; px of the working grid"),
        "colours": layout("float16", "object end lightness a b", "share"),
        "camera": layout("float32", "frame xy", "the background's median motion to the next frame, px/frame"),
    },
    tasks=(BOTH_ENDS,),
)
