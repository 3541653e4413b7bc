"""The overview of backends lists all backends, and nothing else."""

import json

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.declared_names import declared_names
from moseg.schemas.errors import StoreError
from moseg.workflows.config.parameters import list_parameters
from moseg.workflows.stages.needed_weights import needed_items, parameters_of
from moseg.workflows.stages.registry import STAGES, all_choices, axes_of
from moseg.workflows.weights.folder import open_weights
from moseg.workflows.weights.overview import describe_pin, weights_rows

BACKENDS = [(choice, backend) for choice in all_choices() for backend in choice.backends]
NETWORKS = [(choice, backend) for choice, backend in BACKENDS if backend.network is not None]


@pytest.mark.parametrize("choice", [choice for choice in all_choices() if choice.parameter], ids=lambda c: c.name)
def test_a_parameter_takes_the_methods_that_are_listed(choice):
    assert list_parameters()[choice.parameter].choices == choice.names


@pytest.mark.parametrize("stage", [stage for stage in STAGES.values() if stage.choices], ids=lambda stage: stage.name)
def test_every_method_of_a_stage_with_a_choice_is_listed(stage):
    listed = {backend.method for choice in stage.choices for backend in choice.backends}
    # The same backend has another task where regions prompt it in place of boxes.
    # Black bars, not the configuration, lead to objects that another method made and that are kept inside the picture.
    not_chosen = {"given", "inside"}
    assert {task.method.removesuffix("-prompts") for task in stage.tasks} - not_chosen <= listed


@pytest.mark.parametrize("stage", STAGES.values(), ids=lambda stage: stage.name)
def test_the_declaration_of_a_stage_is_consistent(stage):
    assert {task.name for task in stage.tasks} == {stage.name}
    assert (stage.method is None) <= (len(stage.tasks) == 1 or stage.name in BY_PLACE)
    assert all((task.run is None) != (task.run_together is None) for task in stage.tasks)
    assert all(("weights" in stage.inputs) for task in stage.tasks if task.network is not None)


BY_PLACE = (
    *("score", "foreground", "object_hypotheses", "rigid_support", "segmentation"),
    *("saliency", "motion_proof", "clustering", "filled_frame"),
)
"""Stages whose method follows from what the sequence has, the kind of motion model, proposals, corrections,
repeated frames, scenes, or what hides the scene."""


def _choose(choice, backend):
    """Return the configuration in which a backend is chosen and nothing else."""
    stage, _, name = choice.parameter.rpartition(".")
    values = {stage: {name: backend.method}} if stage else {}
    source = backend.option.removeprefix("--proposals ") or "detections"
    return PipelineConfig.model_validate({"proposal_source": source, **values})


@pytest.mark.parametrize(("choice", "backend"), NETWORKS, ids=lambda each: getattr(each, "name", None))
def test_a_network_reads_the_weights_that_are_listed_for_it(choice, backend):
    network = backend.network
    assert needed_items(_choose(choice, backend)).get(network.default) == network.architecture
    default = getattr(PipelineConfig(), network.parameter.partition(".")[0]).weights
    assert default in (None, network.default)


def test_every_weights_item_is_taken_by_a_backend_and_every_default_exists():
    weights = open_weights({"MOSEG_WEIGHTS": "/nowhere"})
    assert {backend.network.architecture for _, backend in NETWORKS} == set(declared_names("weights.architecture"))
    assert all(row.parameters for row in weights_rows(weights, parameters_of))
    for _, backend in NETWORKS:
        assert weights.item(backend.network.default).architecture == backend.network.architecture


def test_arrays_without_the_layouts_of_the_stage_are_rejected():
    flow = np.zeros((4, 5, 2), np.float32)
    assert axes_of("flow", {"flow": flow}) == {"flow": ("y", "x", "uv")}
    for arrays in ({"flow": flow.astype(float)}, {"flow": flow[0]}, {"flows": flow}, {}):
        with pytest.raises(StoreError, match="flow"):
            axes_of("flow", arrays)


def test_sizes_of_present_files_are_those_on_disk(tmp_path):
    weights = open_weights({"MOSEG_WEIGHTS": str(tmp_path)})
    (tmp_path / "pips").mkdir()
    (tmp_path / "pips" / "model.pth").write_bytes(b"12345")
    sizes = {row.item.name: row.size for row in weights_rows(weights, parameters_of)}
    assert sizes["pips"] == 5
    assert sizes["raft-small"] == 4_006_189


def test_the_overview_shows_the_size_of_own_files(tmp_path, moseg, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path))
    item = {"name": "own", "architecture": "raft", "files": [{"name": "model.pth"}]}
    (tmp_path / "weights.json").write_text(json.dumps({"items": [item]}))
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "model.pth").write_bytes(bytes(5000))
    row = next(line for line in moseg("backends").out.splitlines() if line.startswith("│ own "))
    assert " 5 kB " in row and "unknown size" not in row


def test_pins_are_named_by_what_they_verify():
    items = open_weights({"MOSEG_WEIGHTS": "/nowhere"}).items
    assert describe_pin(items["raft-large"]) == "SHA-256"
    assert describe_pin(items["depth-anything-v2-base"]) == "revision"
    assert describe_pin(items["dpt-dinov2-large-nyu"]) == "revision, SHA-256"
    assert describe_pin(items["pips"]) == "first download"


def test_the_overview_shows_present_weights_and_how_to_get_the_others(tmp_path, moseg, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path))
    (tmp_path / "raft-large").mkdir()
    (tmp_path / "raft-large" / "model.pth").write_bytes(b"")
    ran = moseg("backends")
    assert (ran.code, ran.err) == (0, "")
    rows = {line.split()[1]: line for line in ran.out.splitlines() if line.startswith("│")}
    assert " yes " in rows["raft-large"] and " no " in rows["raft-small"]
    assert "CC-BY-NC-4.0 (opt-in)" in rows["depth-anything-v2-large"]
    commands = [line.strip() for line in ran.out.splitlines() if line.startswith("    moseg weights fetch ")]
    assert "moseg weights fetch raft-small" in commands and "moseg weights fetch raft-large" not in commands
    assert "moseg weights fetch depth-anything-v2-large --non-commercial" in commands
    assert "SAM-License (opt-in)" in rows["sam3"]
    assert "moseg weights fetch sam3 --accept-licence SAM-License" in commands
    assert sorted(path.name for path in tmp_path.iterdir()) == ["raft-large"]
