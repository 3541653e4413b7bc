"""Linking: a section's objects become objects of the sequence."""

from itertools import pairwise

import numpy as np

from moseg.schemas.parameters import LinkingParams
from moseg.tasks.proposals.given import link_identities
from moseg.tasks.proposals.linking import count_overlaps, link_sections
from moseg.workflows.stages.task import Output, Task


def _run_overlap(params, inputs, rng):
    sections = inputs.all("proposals")
    num_objects = [section.shape("scores")[0] for section in sections]
    overlaps = []
    # The last section has no next one: its length is not used.
    for index, (section0, section1) in enumerate(pairwise(sections)):
        length = params["lengths"][index]
        tail = section0.rows("masks", length, section0.shape("masks")[0])
        head = section1.rows("masks", 0, len(tail))
        overlaps.append(count_overlaps(tail, head, *num_objects[index : index + 2]))
    identity = link_sections(overlaps, num_objects, LinkingParams.of_recipe(params["linking"]))
    return Output({"identity": identity}, {"num_objects": int(identity.max(initial=0)) + 1})


def _run_given(params, inputs, rng):
    sections = [section.attributes for section in inputs.all("proposals")]
    identity, given = link_identities([np.array(section["identities"], np.uint16) for section in sections])
    result = {"num_objects": len(given) + 1, "given": given.tolist()}
    if all("tags" in section for section in sections):
        tags = {}
        for section in sections:
            tags |= dict(zip(section["identities"], section["tags"], strict=True))
        result["tags"] = [tags[identity] for identity in given.tolist()]
    return Output({"identity": identity}, result)


BY_OVERLAP = Task("linking", "overlap", version=1, run=_run_overlap)
BY_IDENTITY = Task("linking", "identity", version=1, run=_run_given)
