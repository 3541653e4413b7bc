"""The decision which objects are static: by the agreement of the views or by the background's group."""

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.parameters import ClusteringParams
from moseg.schemas.presets import GEOMETRIES
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.clustering import MOTION_GROUPS


def _refs(task, count):
    return tuple(f"{task}/{digest_bytes('test', str(number).encode())}" for number in range(count))


LEAVES = SequenceLeaves(
    name="toy",
    shape=(48, 64),
    frames=_refs("frame", 5),
    masks=_refs("given_masks", 1)[0],
    motion_weights=_refs("motion_weights", 1)[0],
)


def _clustering(variant=Variant.FUSED, proposal_source="saliency", affinity=None, **clustering):
    """Return the parameters of the clustering of a variant's score."""
    config = PipelineConfig(proposal_source=proposal_source, clustering=clustering, affinity=affinity or {})
    graph = SequenceGraph(LEAVES, config)
    return graph.recipes[graph.clustering(variant)].params["clustering"]


@pytest.mark.parametrize("variant", [Variant.FUSED, Variant.OC_DEPTH, Variant.OC, Variant.TRAJS])
def test_only_proposals_from_motion_need_agreement_to_be_dropped(variant):
    assert _clustering(variant)["static"] == "agreement"
    assert _clustering(variant, "tracks")["static"] == "agreement"
    assert _clustering(variant, "groundtruth")["static"] == "group"
    assert _clustering(variant, static="group")["static"] == "group"
    assert _clustering(variant, "groundtruth", static="agreement")["static"] == "agreement"


def test_a_given_number_of_motions_decides_what_is_static():
    assert "static" not in _clustering(motions=3)
    assert _clustering(motions=3, static="agreement") == _clustering(motions=3, static="group")


def test_agreement_reads_the_threshold_for_every_counting_method():
    assert "threshold" in _clustering(auto="eigengap")
    assert "threshold" not in _clustering(auto="eigengap", static="group")


def test_the_papers_geometry_keeps_the_papers_decision():
    values = GEOMETRIES["paper"]
    assert _clustering(affinity=values["affinity"], **values["clustering"])["static"] == "group"


class _Artifact(dict):
    def array(self, name):
        return self[name]


class _Inputs(dict):
    def all(self, role):
        return [_Artifact(each) for each in self[role]]


@pytest.mark.parametrize(("static", "motion"), [("agreement", [0, 1]), ("group", [0, 0])])
def test_an_undecided_view_keeps_an_object_only_by_agreement(static, motion):
    alike = np.full((2, 2), 0.9)
    blind = {"affinity": alike, "static_support": np.array([1.0, 1.0])}
    badly_fitted = {"affinity": alike, "static_support": np.array([1.0, 0.01])}
    named = ClusteringParams(static=static).model_dump(exclude={"motions", "count"})
    params = {"num_motions": None, "clustering": named}
    output = MOTION_GROUPS.run(params, _Inputs(affinities=[blind, badly_fitted]), np.random.default_rng(0))
    assert output.arrays["motion"].tolist() == motion


@pytest.mark.parametrize(("number", "motion"), [(None, [0, 1, 0, 1]), (2, [0, 1, 0, 1]), (1, [0, 0, 0, 0])])
def test_a_rigid_scene_decides_before_the_views_whether_the_number_is_found_or_given(number, motion):
    # The views take object 1 for static and 2 for moving; no section could compare object 3.
    view = {"affinity": np.ones((4, 4)), "static_support": np.array([1.0, 1.0, 0.0, 0.0])}
    sections = [{"support": np.array([1.0, *others, np.nan])} for others in ((1.0, 1.0), (0.0, np.nan))]
    named = ClusteringParams(static="agreement").model_dump(exclude={"motions", "count"})
    inputs = _Inputs(affinities=[view, view], rigid_support=sections)
    params = {"num_motions": number, "clustering": named}
    assert MOTION_GROUPS.run(params, inputs, np.random.default_rng(0)).arrays["motion"].tolist() == motion
