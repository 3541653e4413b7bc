"""The overview of backends lists what there is, and nothing else."""

import json
from typing import get_args

import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import DepthParams, FlowParams, TrackParams
from moseg.schemas.parameters.detections import DetectionParams
from moseg.schemas.weights import Architecture
from moseg.workflows.stages.needed_weights import needed_items
from moseg.workflows.stages.registry import TASKS
from moseg.workflows.weights.backends import BACKENDS, describe_pin, weights_rows
from moseg.workflows.weights.folder import open_weights

CHOICES = {
    "flow": (FlowParams, "method"),
    "depth": (DepthParams, "method"),
    "tracks": (TrackParams, "method"),
    "proposals": (PipelineConfig, "proposal_source"),
    "tagger": (DetectionParams, "tagger"),
    "masks": (DetectionParams, "masks"),
    "tracker": (DetectionParams, "tracker"),
}
TASK_OF_STAGE = {"tagger": "tags", "detector": "detections", "masks": "instances", "tracker": "proposals"}
NO_PARAMETER = {"tagger": {"given"}}
"""Chosen otherwise than by the stage's parameter."""


@pytest.mark.parametrize("stage", CHOICES)
def test_every_choice_of_a_stage_is_listed_and_no_other(stage):
    params, name = CHOICES[stage]
    listed = [backend.method for backend in BACKENDS if backend.stage == stage]
    assert sorted(listed) == sorted({*get_args(params.model_fields[name].annotation), *NO_PARAMETER.get(stage, ())})


def test_every_network_is_a_task():
    networks = {
        (TASK_OF_STAGE.get(backend.stage, backend.stage), backend.method)
        for backend in BACKENDS
        if backend.architecture
    }
    assert networks <= set(TASKS)


def test_every_task_of_a_stage_is_listed():
    stages = {TASK_OF_STAGE.get(backend.stage, backend.stage) for backend in BACKENDS}
    listed = {(TASK_OF_STAGE.get(backend.stage, backend.stage), backend.method) for backend in BACKENDS}
    given = {(stage, "given") for stage in stages}
    assert {task for task in TASKS if task[0] in stages} - given <= listed


def _choose(backend):
    """The configuration in which a backend is chosen and nothing else."""
    if backend.stage in ("flow", "depth", "tracks"):
        return PipelineConfig.model_validate({backend.stage: {"method": backend.method}})
    detections = {} if backend.stage == "detector" else {backend.stage: backend.method}
    return PipelineConfig.model_validate({"proposal_source": "detections", "detections": detections})


@pytest.mark.parametrize("backend", [backend for backend in BACKENDS if backend.architecture], ids=lambda b: b.option)
def test_a_network_reads_the_weights_that_are_listed_for_it(backend):
    assert needed_items(_choose(backend)).get(backend.weights[1]) == backend.architecture


def test_every_weights_item_is_taken_by_a_backend_and_every_default_exists():
    weights = open_weights({"MOSEG_WEIGHTS": "/nowhere"})
    assert {backend.architecture for backend in BACKENDS} - {None} == set(get_args(Architecture))
    assert all(row.parameters for row in weights_rows(weights))
    for backend in BACKENDS:
        if backend.architecture:
            assert weights.item(backend.weights[1]).architecture == backend.architecture


def test_sizes_are_those_on_disk_where_the_files_are_here(tmp_path):
    weights = open_weights({"MOSEG_WEIGHTS": str(tmp_path)})
    (tmp_path / "pips").mkdir()
    (tmp_path / "pips" / "model.pth").write_bytes(b"12345")
    sizes = {row.item.name: row.size for row in weights_rows(weights)}
    assert sizes["pips"] == 5
    assert sizes["raft-small"] == 4_006_189


def test_the_overview_tells_the_size_of_own_files(tmp_path, moseg, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path))
    item = {"name": "own", "architecture": "raft", "files": [{"name": "model.pth"}]}
    (tmp_path / "weights.json").write_text(json.dumps({"items": [item]}))
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "model.pth").write_bytes(bytes(5000))
    row = next(line for line in moseg("backends").out.splitlines() if line.startswith("│ own "))
    assert " 5 kB " in row and "unknown size" not in row


def test_pins_are_named_honestly():
    items = open_weights({"MOSEG_WEIGHTS": "/nowhere"}).items
    assert describe_pin(items["raft-large"]) == "SHA-256"
    assert describe_pin(items["depth-anything-v2-base"]) == "revision"
    assert describe_pin(items["dpt-dinov2-large-nyu"]) == "revision, SHA-256"
    assert describe_pin(items["pips"]) == "first download"


def test_the_overview_says_what_is_here_and_how_to_get_the_rest(tmp_path, moseg, monkeypatch):
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
    assert sorted(path.name for path in tmp_path.iterdir()) == ["raft-large"]
