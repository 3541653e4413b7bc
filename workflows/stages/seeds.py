"""Seeds: objects from which the tracking of a section starts, found in its first frame or tracked into it."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import SeedParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.instances import merge_seeds

    found = inputs["found"]
    tracked, identities, tags, num_identities = None, np.zeros(0, np.uint16), [], 0
    if "tracked" in inputs:
        before = inputs["tracked"]
        last = before.shape("masks")[0] - 1
        tracked = before.rows("masks", last, last + 1)[0]
        identities = np.array(before.attributes["identities"], np.uint16)
        tags, num_identities = before.attributes["tags"], before.attributes["num_identities"]
    seeds = merge_seeds(
        tracked,
        identities,
        num_identities,
        found.array("labels"),
        found.array("scores"),
        SeedParams.of_recipe(params["seeds"]),
    )
    known = dict(zip(identities.tolist(), tags, strict=True))
    names = found.attributes["tags"]
    return Output(
        {"labels": seeds.labels, "scores": seeds.scores, "identities": seeds.identities},
        {
            "num_identities": seeds.num_identities,
            "tags": [
                known.get(identity) or (names[source - 1] if source else "")
                for identity, source in zip(seeds.identities.tolist(), seeds.found.tolist(), strict=True)
            ],
        },
    )


def _params(config: PipelineConfig) -> dict:
    return {"seeds": config.seeds.model_dump(mode="json")}


MASK_OVERLAP = Task("seeds", "mask-overlap", version=2, run=_run, params=_params)

STAGE = Stage(
    name="seeds",
    about="objects that a section's tracking starts with",
    inputs={"found": "instances of the section's first frame", "tracked": "proposals of the section before"},
    arrays={
        "labels": layout("uint16", "y x", "object of the section, 0 = background"),
        "scores": layout("float64", "object"),
        "identities": layout("uint16", "object", "object of the sequence"),
    },
    tasks=(MASK_OVERLAP,),
)
