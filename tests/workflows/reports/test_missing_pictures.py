"""Pictures whose artifacts are absent are left out and named; damaged artifacts are errors."""

import pytest

from moseg.schemas.configs import Variant
from moseg.schemas.errors import CorruptArtifactError
from moseg.schemas.recipes import split_ref
from moseg.store import open_store
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.missing import WhyAbsent
from moseg.workflows.reports.pictures import gather_pictures
from moseg.workflows.reports.subject import read_subject
from moseg.workflows.runlog.status import list_runs

FUSED = (Variant.FUSED,)
LAYERS = {"frame", "motion saliency", "optical flow", "flow relative to the background", "ground truth", "proposals"}
LAYERS |= {"moving objects (fused)", "errors (fused)", "tracks"}


@pytest.fixture
def run(evaluated_copy):
    """A copy of the store of the evaluated squares, their graph and its parameters."""
    store = open_store(str(evaluated_copy.store), create=False)
    subject = read_subject(store, list_runs(store)[0])
    return store, SequenceGraph(subject.sequences[0].leaves, subject.config), subject.config


def _drop(store, *tasks):
    for ref in [ref for task in tasks for ref in store.refs(task)]:
        store.remove(ref)


def _read_missing(text):
    """Return why artifacts are absent, and the absent artifacts of each part."""
    why, _, parts = text.removesuffix("].").partition(": ")
    return why, dict(part.split(" [") for part in parts.split("]; "))


@pytest.mark.parametrize(
    ("task", "names"),
    [
        ("saliency", {"motion saliency", "flow relative to the background"}),
        ("flow", {"optical flow"}),
        ("tracks", {"tracks"}),
        ("proposals", {"proposals"}),
        ("frame", {"frame", "video of fused"}),
        (
            "segmentation",
            {"moving objects (fused)", "errors (fused)", "table of objects", "video of fused"},
        ),
    ],
)
def test_layers_without_their_artifacts_are_left_out_and_named(run, task, names):
    store, graph, config = run
    _drop(store, task)
    pictures = gather_pictures(store, graph, config, FUSED, 2, fps=5.0)
    why, parts = _read_missing(*pictures.missing)
    assert why == WhyAbsent.GONE and set(parts) == names
    assert all(task in stages for stages in parts.values())
    assert {layer.name for layer in pictures.layers} == LAYERS - names
    assert (pictures.video is None) == ("video of fused" in names)


def test_a_variant_that_never_ran_and_absent_ground_truth_are_named(run):
    store, graph, config = run
    store.remove(graph.leaves.annotation)
    pictures = gather_pictures(store, graph, config, (Variant.FUSED, Variant.OC), 2, fps=5.0)
    assert pictures.frames == (2, 7)
    absent, said = pictures.missing
    assert said == "The ground truth is no longer in the store."
    assert set(_read_missing(absent)[1]) == {"ground truth", "errors (fused)", "errors (oc)", "moving objects (oc)"}


def test_artifacts_of_a_running_run_are_not_called_collected(run):
    store, graph, config = run
    _drop(store, "flow", "segmentation")
    pictures = gather_pictures(store, graph, config, FUSED, 2, 5.0, WhyAbsent.NOT_YET)
    (said,) = pictures.missing
    assert said.startswith("Not computed yet: ") and said.count("omputed") == 1
    parts = _read_missing(said)[1]
    assert parts["optical flow"] == "2 flow" and parts["table of objects"] == "3 segmentation"


def test_a_damaged_artifact_is_an_error(run, evaluated_copy):
    store, graph, config = run
    task, key = split_ref(graph.frame_cues.flow(5, 6))
    files = [path for path in (evaluated_copy.store / "objects" / task / key[:2] / key).rglob("*") if path.is_file()]
    largest = max(files, key=lambda path: path.stat().st_size)
    largest.write_bytes(largest.read_bytes()[:-1])
    with pytest.raises(CorruptArtifactError):
        gather_pictures(store, graph, config, FUSED, 1, fps=5.0)


def test_timelines_without_frames_have_no_thumbnails(run):
    store, graph, config = run
    _drop(store, "frame")
    pictures = gather_pictures(store, graph, config, FUSED, 2, fps=5.0)
    assert len(pictures.timelines) == len(pictures.objects) > 0
    assert {each.thumbnails for each in pictures.timelines} == {()}
