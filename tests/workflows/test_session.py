"""A run resumes, repairs what is damaged and gives the same bytes on every scheduler, alone or beside others."""

import json
import signal
import subprocess
import sys
import time

import pytest

from schemas.configs import PipelineConfig, Variant
from schemas.recipes import split_ref
from store import open_store
from workflows.datasets import open_dataset
from workflows.evaluate import evaluate
from workflows.runners import SynchronousRunner
from workflows.session import Session

LEAVES = {"frame", "annotation"}
MOSEG = [sys.executable, "-c", "from workflows.cli import main; main()"]
DEADLINE_SEC = 120


def _contents(store):
    """Every artifact's arrays, by digest of their bytes, and results."""
    found = {}
    for ref in store.refs():
        manifest = store.manifest(ref)
        found[ref] = ({entry.name: entry.digest for entry in manifest.arrays}, manifest.attributes)
    return found


def _open(evaluation):
    return open_store(str(evaluation.store), create=False)


def _drop(store, tasks):
    """Remove all artifacts of some tasks; returns how many."""
    return sum(store.remove(ref) for task in tasks for ref in list(store.refs(task)))


def _files(evaluation, ref):
    """Files of an artifact, the largest first, its manifest last."""
    task, key = split_ref(ref)
    folder = evaluation.store / "objects" / task / key[:2] / key
    files = sorted((path for path in folder.rglob("*") if path.is_file()), key=lambda path: -path.stat().st_size)
    return sorted(files, key=lambda path: path.name == "manifest.json")


def _flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0x10
    path.write_bytes(content)


def _quarantined(evaluation):
    reasons = (evaluation.store / "quarantine").glob("*/reason.json")
    return sorted(json.loads(path.read_text())["ref"] for path in reasons)


def _run(moseg, evaluation, tmp_path, *more):
    """Evaluate again; the report."""
    ran = moseg(*evaluation.arguments, "--store", evaluation.store, "--json", tmp_path / "again.json", *more)
    assert (ran.code, ran.err) == (0, "")
    return json.loads((tmp_path / "again.json").read_text())


def test_a_warm_run_computes_nothing(evaluated, moseg, tmp_path):
    before = _contents(_open(evaluated))
    report = _run(moseg, evaluated, tmp_path)
    assert report["store"]["computed"] == 0
    assert report["rows"] == evaluated.report["rows"]
    assert _contents(_open(evaluated)) == before


@pytest.mark.parametrize(
    ("dropped", "recomputed"),
    [
        (["score"], ["score"]),
        (["segmentation", "score"], ["segmentation", "score"]),
        (["affinity", "clustering", "score"], ["score"]),
        (["clustering", "segmentation", "score"], ["clustering", "segmentation", "score"]),
        (["fundamental", "flow_model", "saliency"], []),
    ],
)
def test_what_was_dropped_is_recomputed_where_it_is_needed(evaluated_copy, moseg, tmp_path, dropped, recomputed):
    store = _open(evaluated_copy)
    before = _contents(store)
    num_needed = sum(len(list(store.refs(task))) for task in recomputed)
    _drop(store, dropped)
    assert _run(moseg, evaluated_copy, tmp_path)["store"]["computed"] == num_needed
    unneeded = {*dropped} - {*recomputed}
    assert _contents(store) == {ref: entry for ref, entry in before.items() if split_ref(ref)[0] not in unneeded}


def _lose(path):
    path.unlink()


def _empty(path):
    path.write_bytes(b"")


@pytest.mark.parametrize("damage", [_flip, _lose, _empty])
@pytest.mark.parametrize(
    ("damaged", "dropped"),
    [
        ("flow", ["saliency", "flow_model", "flow_residual", "affinity", "clustering", "segmentation", "score"]),
        ("frame", ["flow", "saliency"]),
        ("annotation", ["score"]),
        ("segmentation", ["score"]),
    ],
)
def test_a_damaged_array_is_quarantined_and_made_again(evaluated_copy, moseg, tmp_path, damage, damaged, dropped):
    store = _open(evaluated_copy)
    before = _contents(store)
    ref = sorted(store.refs(damaged))[0]
    damage(_files(evaluated_copy, ref)[0])
    num_dropped = _drop(store, dropped)
    report = _run(moseg, evaluated_copy, tmp_path)
    assert report["rows"] == evaluated_copy.report["rows"]
    assert _contents(store).items() >= {r: e for r, e in before.items() if split_ref(r)[0] != "saliency"}.items()
    assert _quarantined(evaluated_copy) == [ref]
    assert all(result.is_intact for result in store.verify())
    assert report["store"]["computed"] <= num_dropped + 1
