"""`moseg store show` traces an artifact up to the leaves and down to the scores."""

import json

import numpy as np
import pytest
import zarr

from moseg.store import open_store


@pytest.fixture
def show(evaluated, moseg):
    """Return a function that returns the JSON, or with other options the text, of an artifact of the squares."""

    def call(key, *options):
        ran = moseg("store", "show", key, *options, "--store", evaluated.store)
        assert (ran.code, ran.err) == (0, "")
        return ran.out if "--summary" in options else json.loads(ran.out)

    return call


@pytest.fixture
def refs(evaluated):
    """Return the references of the evaluated squares by task."""
    found = {}
    for ref in open_store(str(evaluated.store), create=False).refs():
        found.setdefault(ref.partition("/")[0], []).append(ref)
    return found


def _by_task(relatives):
    counts = {}
    for relative in relatives:
        assert relative["state"] == "stored"
        task = relative["ref"].partition("/")[0]
        counts[task] = counts.get(task, 0) + 1
    return counts


def test_upstream_of_a_score_reaches_every_stage_and_leaf(show, refs):
    shown = show(refs["score"][0])
    found = _by_task(shown["upstream"])
    # A choice and repetitions decide which recipes are written; they are inputs of none.
    assert found.keys() == refs.keys() - {"score", "ingest", "scene_parallax", "repetitions"}
    for task in ("frame", "annotation", "flow", "saliency", "proposals", "segmentation"):
        assert found[task] == len(refs[task])
    assert shown["downstream"] == []
    inputs = [shown["recipe"]["inputs"]["annotation"], *shown["recipe"]["inputs"]["segmentation"]]
    assert sorted(each["ref"] for each in shown["upstream"] if each["depth"] == 1) == sorted(inputs)


def test_downstream_of_a_frame_leads_to_the_score(show, refs):
    shown = show(refs["frame"][0])
    assert shown["upstream"] == []
    assert refs["score"][0] in [each["ref"] for each in shown["downstream"]]
    assert _by_task(shown["downstream"])["segmentation"] == len(refs["segmentation"])
    depths = [each["depth"] for each in shown["downstream"]]
    assert depths == sorted(depths) and depths[0] == 1


def test_up_and_down_are_each_others_reverse(show, refs):
    flow = refs["flow"][0]
    for child in show(flow)["downstream"]:
        assert {"ref": flow, "depth": child["depth"], "state": "stored"} in show(child["ref"])["upstream"]


def test_downstream_can_be_left_out(show, refs):
    shown = show(refs["flow"][0], "--no-downstream")
    assert "downstream" not in shown
    assert shown["upstream"]


def test_the_place_opens_in_zarr(show, refs, evaluated):
    ref = refs["flow"][0]
    group = zarr.open_group(show(ref)["place"], mode="r")
    found = open_store(str(evaluated.store), create=False).read(ref, "flow")
    np.testing.assert_array_equal(group["flow"][:], found)


def test_the_summary_names_shared_parameters_and_counts_others(show, refs):
    lines = [line.strip() for line in show(refs["score"][0], "--summary").splitlines()]
    assert lines[0] == refs["score"][0]
    assert any(line.startswith(f"{len(refs['flow'])}  flow  (version ") for line in lines)
    assert "affinity.scale = 0.5" in lines
    assert f"content = {len(refs['frame'])} values" in lines
    assert lines[-1] == "downstream: 0 artifacts"


def test_a_removed_artifact_is_named_and_ends_the_trace(evaluated_copy, moseg):
    store = open_store(str(evaluated_copy.store), create=False)
    (score,) = store.refs("score")
    for ref in list(store.refs("segmentation")):
        store.remove(ref)
    shown = moseg("store", "show", score, "--store", evaluated_copy.store).out
    assert {each["state"] for each in json.loads(shown)["upstream"] if "segmentation/" in each["ref"]} == {"absent"}
    assert "flow/" not in shown
    summary = moseg("store", "show", score, "--summary", "--store", evaluated_copy.store).out
    assert "not in this store or damaged" in summary


def test_a_whole_key_is_found_without_a_listing(evaluated, moseg, refs, monkeypatch):
    monkeypatch.setattr("moseg.store.LocalStore.refs", None)
    flow = refs["flow"][0]
    for key in (flow, flow.partition("/")[2]):
        ran = moseg("store", "show", key, "--no-downstream", "--store", evaluated.store)
        assert (ran.code, json.loads(ran.out)["key"]) == (0, flow.partition("/")[2])
    ran = moseg("store", "show", f"depth/{flow.partition('/')[2]}", "--no-downstream", "--store", evaluated.store)
    assert ran.code == 2


@pytest.mark.parametrize("task", ["score", "ingest"])
def test_a_whole_key_of_a_task_without_arrays_is_found(show, refs, task):
    key = refs[task][0].partition("/")[2]
    assert show(key, "--no-downstream")["key"] == key
