"""Objects that SAM 3 finds by name, outlines and tracks in place of four networks."""

import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.presets import SOURCE_DEFAULTS
from moseg.store import open_store
from moseg.workflows.config.notes import evaluation_notes
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.needed_weights import needed_items

NUM_FRAMES = 8
CHOSEN = ("--proposals", "sam3", "--section-length", "4")


def _ref(task, text):
    return f"{task}/{digest_bytes('test', text.encode())}"


def _config(**changes):
    values = {"proposal_source": "sam3", "sections": {"length": 4, "overlap": 2}, **SOURCE_DEFAULTS["sam3"]}
    for stage, given in changes.items():
        values[stage] = {**values.get(stage, {}), **given}
    return PipelineConfig.model_validate(values)


def _recipes(config, task, num_frames=9):
    weights = {name: _ref("weights", name) for name in needed_items(config)}
    frames = tuple(_ref("frame", str(number)) for number in range(num_frames))
    graph = SequenceGraph(SequenceLeaves("toy", (48, 64), frames, weights=weights), config)
    graph.segmentations(Variant.FUSED)
    return {ref: recipe for ref, recipe in graph.recipes.items() if recipe.task == task}


@pytest.fixture(scope="module")
def tiny(tmp_path_factory):
    """Return a folder of the tiny checkpoint."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("tiny")
    assert run(["weights", "tiny", str(folder), "--only", "sam3"]) == 0
    return folder


@pytest.fixture
def segment(moseg, tiny, write_squares, tmp_path, monkeypatch):
    """Return a function that runs `moseg segment` on a video of two squares, with a store of a given name."""
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tiny))
    monkeypatch.setenv("MOSEG_OFFLINE", "1")
    video = write_squares(tmp_path / "clip", num_frames=NUM_FRAMES) / "frames"

    def call(store, *arguments):
        return moseg(
            "segment", video, "--store", tmp_path / store, "--out", tmp_path / f"{store}-out", "--quiet", *arguments
        )

    return call


def test_one_network_takes_the_place_of_four():
    config = _config()
    assert needed_items(config) == {"sam3": "sam3"}
    assert not _recipes(config, "tags") and not _recipes(config, "detections")
    found, tracked = (_recipes(config, task).values() for task in ("instances", "proposals"))
    assert len(found) == len(tracked) == 3
    assert {recipe.params["method"] for recipe in (*found, *tracked)} == {"sam3"}
    assert all(recipe.inputs.keys() == {"frame", "weights"} for recipe in found)


def test_its_objects_can_be_tracked_by_another_network():
    assert needed_items(_config(detections={"tracker": "deaot"})) == {"sam3": "sam3", "deaot-r50-l": "deaot"}


def test_given_tags_take_the_place_of_its_concepts():
    by_tags = _recipes(_config(detections={"tags": "dog,cat"}), "instances")
    by_concepts = _recipes(_config(sam3={"concepts": "dog,cat"}), "instances")
    assert by_tags.keys() == by_concepts.keys() and by_tags.keys().isdisjoint(_recipes(_config(), "instances"))
    assert {tuple(recipe.params["sam3"]["concepts"]) for recipe in by_tags.values()} == {("dog", "cat")}


@pytest.mark.parametrize(
    ("parameter", "value", "moved", "kept"),
    [
        ("concepts", ("dog",), "instances", "proposals"),
        ("min_score", 0.7, "instances", "proposals"),
        ("memory_reach", 3, "proposals", "instances"),
    ],
)
def test_finding_and_tracking_read_only_their_parameters(parameter, value, moved, kept):
    before, after = (
        {task: [recipe.params for recipe in _recipes(config, task).values()] for task in (moved, kept)}
        for config in (_config(), _config(sam3={parameter: value}))
    )
    assert before[moved] != after[moved] and before[kept] == after[kept]


def test_later_frames_leave_the_keys_of_earlier_sections():
    short, long = (_recipes(_config(), "proposals", count).keys() for count in (9, 13))
    assert len(short & long) == 2


def test_an_evaluation_names_what_was_looked_for():
    note, *_ = evaluation_notes(_config(detections={"tags": "dog,cat"}), [Variant.TRAJS])
    assert note.startswith("proposals sam3 (dog, cat; sam3), ")


def test_named_objects_are_found_and_tracked_with_the_same_bytes_in_two_workers(segment, contents_of, tmp_path):
    ran = segment("one", *CHOSEN, "--tags", "person,dog")
    assert ran.code == 0, ran.err
    store = open_store(str(tmp_path / "one"), create=False)
    tracked = [store.manifest(ref).attributes for ref in store.refs() if ref.startswith("proposals/")]
    assert len(tracked) == 2
    assert all(found["tags"] and set(found["tags"]) <= {"person", "dog"} for found in tracked)
    assert segment("two", *CHOSEN, "--tags", "person,dog", "--workers", "2").code == 0
    assert contents_of(tmp_path / "two") == contents_of(tmp_path / "one")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--masks", "sam2"), ("--masks", "proposals sam3")),
        (("--tagger", "ram"), ("--tagger", "proposals sam3")),
        (("--set", "sam3.concepts="), ("sam3.concepts", "names of objects")),
        (("--set", "sam3.weights=sam-hq-vit-large"), ("sam-hq-vit-large", "sam3")),
    ],
)
def test_contradictory_options_are_one_line(options, words, segment):
    ran = segment("store", *CHOSEN, *options)
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert all(word in line for word in words), line


def test_published_weights_need_the_licence_to_be_accepted_by_name(segment, tmp_path, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path / "none"))
    monkeypatch.delenv("MOSEG_ACCEPT_LICENCE", raising=False)
    for options in ((), ("--non-commercial",)):
        ran = segment("store", *CHOSEN, *options)
        assert ran.code == 2
        (line,) = ran.err.splitlines()
        assert "--accept-licence SAM-License" in line and "huggingface.co/facebook/sam3" in line
    ran = segment("store", *CHOSEN, "--accept-licence", "SAM-License")
    (line,) = ran.err.splitlines()
    assert ran.code == 2 and "moseg weights fetch sam3 --accept-licence SAM-License" in line
