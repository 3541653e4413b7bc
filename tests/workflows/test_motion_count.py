"""The inputs and parameters of a clustering's recipe if the number of motions is to be found."""

import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.parameters.clustering import COUNT_READS, READ_TRACKS
from moseg.workflows.graph import SequenceGraph, SequenceLeaves


def _clustering(**clustering):
    frames = tuple(f"frame/{digest_bytes('test', str(number).encode())}" for number in range(5))
    leaves = SequenceLeaves(
        name="toy",
        shape=(48, 64),
        frames=frames,
        num_motions=2,
        motion_weights=f"motion_weights/{digest_bytes('test', b'')}",
    )
    graph = SequenceGraph(leaves, PipelineConfig(clustering=clustering))
    return graph.recipes[graph.clustering(Variant.OC)]


@pytest.mark.parametrize("auto", READ_TRACKS)
def test_tracks_are_inputs_of_the_counting_methods_that_read_them(auto):
    assert {"tracks", "linking"} <= set(_clustering(auto=auto).inputs)
    assert set(_clustering(auto=auto, motions="gt").inputs) == {"affinities"}


@pytest.mark.parametrize("auto", ["threshold", "eigengap", "confidences"])
def test_no_other_counting_method_has_tracks_as_inputs(auto):
    assert set(_clustering(auto=auto).inputs) == {"affinities"}


@pytest.mark.parametrize("auto", COUNT_READS)
def test_only_the_parameters_that_are_read_are_part_of_the_recipe(auto):
    assert set(_clustering(auto=auto).params["clustering"]["count"]) == COUNT_READS[auto]
    assert "count" not in _clustering(auto=auto, motions=3).params["clustering"]


def test_parameters_that_are_not_read_change_no_key():
    assert _clustering() == _clustering(count={"gap": 1})
    unread = {"motion_price": 0.5, "least_silhouette": 0.1}
    assert _clustering(auto="description_length") == _clustering(auto="description_length", count=unread)
