"""Linking: identities in the sequence of the objects of its sections."""

from itertools import pairwise

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import MOTION_SOURCES, PipelineConfig
from moseg.schemas.parameters import IdentityParams, LinkingParams
from moseg.workflows.stages.corrected_objects import object_names
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

RETURN_PARAMS = frozenset(
    {"min_area", "return_gap", "rejoin_gap", "rejoin_growth", "rejoin_turn", "rejoin_drift"}
    | {"rejoin_reach", "rejoin_stray", "rejoin_colour"}
)
"""Parameters of the identities by which an object is known again after a gap."""


def _run_overlap(params, inputs, rng):
    from moseg.tasks.proposals.linking import count_overlaps, link_sections
    from moseg.tasks.proposals.parts import join_parts
    from moseg.tasks.proposals.returning import Sightings, find_returns

    sections = inputs.all("proposals")
    num_objects = [section.shape("scores")[0] for section in sections]
    overlaps = []
    # The length of the last section is not used, because no section follows it.
    for index, (section0, section1) in enumerate(pairwise(sections)):
        length = params["lengths"][index]
        # A short section from tracks reaches less far than one from saliency before it.
        num_shared = min(section0.shape("masks")[0] - length, section1.shape("masks")[0])
        tail = section0.rows("masks", length, length + num_shared)
        head = section1.rows("masks", 0, num_shared)
        overlaps.append(count_overlaps(tail, head, *num_objects[index : index + 2]))
    linking = LinkingParams.of_recipe(params["linking"])
    identity = link_sections(overlaps, num_objects, linking)
    if "sightings" in inputs:
        seen = dict(zip(params["seen"], inputs.all("sightings"), strict=True))
        read = [_read_sightings(seen.get(index), section, Sightings) for index, section in enumerate(sections)]
        starts = np.cumsum([0, *params["lengths"][:-1]]).tolist()
        frame_area = next(iter(seen.values())).attributes["frame_area"]
        identity_params = IdentityParams.of_recipe(params["identity"])
        identity = join_parts(identity, overlaps, read, linking, identity_params)
        identity = find_returns(identity, starts, read, frame_area, identity_params)
    return Output({"identity": identity}, {"num_objects": int(identity.max(initial=0)) + 1})


def _read_sightings(sightings, section, kind):
    """Return the sightings of a section's objects; None where there are none."""
    if sightings is None:
        return None
    found = kind(*(sightings.array(name) for name in kind._fields))
    if "kept" not in section.attributes:
        return found
    kept = np.array(section.attributes["kept"], np.intp) - 1
    return found._replace(frames=found.frames[kept], places=found.places[kept], colours=found.colours[kept])


def _run_given(params, inputs, rng):
    from moseg.tasks.proposals.given import link_identities

    sections = [section.attributes for section in inputs.all("proposals")]
    identity, given = link_identities([np.array(section["identities"], np.uint16) for section in sections])
    result = {"num_objects": len(given) + 1, "given": given.tolist()}
    if all("tags" in section for section in sections):
        tags = {}
        for section in sections:
            tags |= dict(zip(section["identities"], section["tags"], strict=True))
        result["tags"] = [tags[identity] for identity in given.tolist()]
    return Output({"identity": identity}, result)


def _run_scenes(params, inputs, rng):
    from moseg.tasks.scenes import join_objects

    scenes = inputs.all("scenes")
    names = [object_names(scene.attributes) for scene in scenes]
    identity, joined = join_objects([scene.cached("identity") for scene in scenes], names)
    result = {"num_objects": len(joined)}
    if any("given" in scene.attributes for scene in scenes):
        result["given"] = joined[1:].tolist()
    if all("tags" in scene.attributes for scene in scenes):
        result["tags"] = [tag for scene in scenes for tag in scene.attributes["tags"]]
    return Output({"identity": identity}, result)


def _overlap_params(config: PipelineConfig, lengths: list[int], seen: list[int]) -> dict:
    """Return the parameters of sections of these lengths, of which those with the indices `seen` have sightings."""
    read = {"lengths": lengths, "linking": config.linking.model_dump(mode="json")}
    if seen:
        read |= {"seen": seen, "identity": config.identity.model_dump(mode="json", include=RETURN_PARAMS)}
    return read


BY_OVERLAP = Task("linking", "overlap", version=3, run=_run_overlap, params=_overlap_params)
BY_IDENTITY = Task("linking", "identity", version=1, run=_run_given)
OF_SCENES = Task("linking", "scenes", version=1, run=_run_scenes)

STAGE = Stage(
    name="linking",
    about="identities of the objects of all sections",
    inputs={
        "proposals": "objects of every section",
        "sightings": "where they begin and end, of the sections whose objects come from saliency",
        "scenes": "linking of every scene, in place of them, where scenes were segmented apart",
    },
    arrays={"identity": layout("uint16", "section object", "object of the sequence, 0 = background")},
    tasks=(BY_OVERLAP, BY_IDENTITY, OF_SCENES),
    # Only proposals found by their motion have no identities of their own from one section to the next.
    method=lambda config: "overlap" if config.proposal_source in MOTION_SOURCES else "identity",
)
