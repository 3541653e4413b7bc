"""A run resumes, repairs damage and gives the same bytes on every scheduler, alone or beside others."""

import json
import signal
import subprocess
import sys

import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.recipes import split_ref
from moseg.store import open_store
from moseg.workflows.cluster.runners import SynchronousRunner
from moseg.workflows.datasets import open_dataset
from moseg.workflows.engine.session import Session
from moseg.workflows.pipelines.evaluate import evaluate

MOSEG = [sys.executable, "-c", "from moseg.workflows.cli import main; main()"]
DEADLINE_SEC = 600


def _contents(store):
    """Return all artifacts' arrays, by digest of their bytes, and attributes."""
    found = {}
    for ref in store.refs():
        manifest = store.manifest(ref)
        found[ref] = ({entry.name: entry.digest for entry in manifest.arrays}, manifest.attributes)
    return found


def _open(evaluation):
    return open_store(str(evaluation.store), create=False)


def _drop(store, tasks):
    """Remove all artifacts of some tasks and return their number."""
    return sum(store.remove(ref) for task in tasks for ref in list(store.refs(task)))


def _files(evaluation, ref):
    """Return the files of an artifact, the largest first, its manifest last."""
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
    """Evaluate again and return the report."""
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
def test_dropped_artifacts_are_recomputed_if_needed(evaluated_copy, moseg, tmp_path, dropped, recomputed):
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


def _read_again(store, task, dropped):
    """Return the artifacts of a task that the flow models or the scores read, or if none, all of it."""
    readers = [ref for reader in ("flow_model", "score") if reader in dropped for ref in store.refs(reader)]
    inputs = {ref for reader in readers for ref in store.manifest(reader).recipe.input_refs()}
    refs = set(store.refs(task))
    return refs & inputs or refs


END = ["affinity", "clustering", "segmentation", "score"]
BEHIND_FLOW = ["saliency", "proposals", "flow_model", "flow_residual", *END]


@pytest.mark.parametrize(
    ("damaged", "damage", "dropped"),
    [
        ("flow", _flip, BEHIND_FLOW),
        ("flow", _lose, BEHIND_FLOW),
        ("frame", _flip, ["flow", *BEHIND_FLOW]),
        ("frame", _empty, ["flow", *BEHIND_FLOW]),
        ("annotation", _flip, ["score"]),
        ("segmentation", _flip, ["score"]),
        ("segmentation", _lose, ["score"]),
    ],
)
def test_a_damaged_array_is_quarantined_and_recomputed(evaluated_copy, moseg, tmp_path, damaged, damage, dropped):
    store = _open(evaluated_copy)
    before = _contents(store)
    ref = sorted(_read_again(store, damaged, dropped))[0]
    damage(_files(evaluated_copy, ref)[0])
    num_dropped = _drop(store, dropped)
    report = _run(moseg, evaluated_copy, tmp_path)
    after = _contents(store)
    assert report["rows"] == evaluated_copy.report["rows"]
    assert after == {found: before[found] for found in after}
    assert {ref, *store.refs("segmentation"), *store.refs("score")} <= after.keys()
    assert _quarantined(evaluated_copy) == [ref]
    assert all(result.is_intact for result in store.verify())
    assert 0 < report["store"]["computed"] <= num_dropped + 1


@pytest.mark.parametrize("damaged", ["score", "ingest"])
@pytest.mark.parametrize("damage", [_flip, _lose])
def test_a_damaged_manifest_is_quarantined_and_recomputed(evaluated_copy, moseg, tmp_path, damaged, damage):
    store = _open(evaluated_copy)
    before = _contents(store)
    ref = sorted(store.refs(damaged))[0]
    damage(_files(evaluated_copy, ref)[-1])
    report = _run(moseg, evaluated_copy, tmp_path)
    assert report["rows"] == evaluated_copy.report["rows"]
    assert report["store"]["computed"] == 1
    assert _contents(store) == before
    assert _quarantined(evaluated_copy) == [ref]


def test_several_damaged_artifacts_are_all_recomputed(evaluated_copy, moseg, tmp_path):
    store = _open(evaluated_copy)
    before = _contents(store)
    damaged = sorted([*sorted(store.refs("segmentation"))[:2], *store.refs("annotation"), *store.refs("score")])
    for ref in damaged:
        _flip(_files(evaluated_copy, ref)[-1])
    report = _run(moseg, evaluated_copy, tmp_path)
    assert report["rows"] == evaluated_copy.report["rows"]
    assert _contents(store) == before
    assert _quarantined(evaluated_copy) == damaged


def test_damage_that_no_sink_needs_is_left_alone(evaluated_copy, moseg, tmp_path):
    ref = sorted(_open(evaluated_copy).refs("saliency"))[0]
    _flip(_files(evaluated_copy, ref)[0])
    assert _run(moseg, evaluated_copy, tmp_path)["store"]["computed"] == 0
    assert _quarantined(evaluated_copy) == []


def test_damaged_labels_do_not_reach_the_users_masks(squares, moseg, tmp_path):
    arguments = ("segment", squares / "squares" / "frames", "--store", tmp_path / "store", "--out", tmp_path / "out")
    assert moseg(*arguments, "--quiet").code == 0
    masks = {path.name: path.read_bytes() for path in (tmp_path / "out" / "masks").iterdir()}
    store = open_store(str(tmp_path / "store"))
    damaged = sorted([*store.refs("segmentation"), sorted(store.refs("frame"))[0]])
    for ref in damaged:
        task, key = split_ref(ref)
        _flip(tmp_path / "store" / "objects" / task / key[:2] / key / "arrays.zip")
    ran = moseg(*arguments, "--quiet")
    assert (ran.code, ran.err) == (0, "")
    assert {path.name: path.read_bytes() for path in (tmp_path / "out" / "masks").iterdir()} == masks
    assert all(result.is_intact for result in store.verify())


class _OtherRunInBetween(SynchronousRunner):
    """Runner before whose first call another run quarantines a damaged artifact."""

    def __init__(self, store, ref):
        self._store, self._ref = store, ref

    def run(self, calls, on_done):
        if calls:
            self._store.quarantine(self._ref, "found damaged by another run")
        super().run(calls, on_done)


def test_an_artifact_that_another_run_quarantines_meanwhile_is_recomputed(evaluated_copy):
    store = _open(evaluated_copy)
    before = _contents(store)
    _drop(store, ["score"])
    ref = sorted(store.refs("segmentation"))[0]
    config = PipelineConfig.model_validate({"sections": {"length": 4, "overlap": 2}})
    data = open_dataset("folder", str(evaluated_copy.root), max_side=config.max_side)
    session = Session(store, _OtherRunInBetween(store, ref), quiet=True)
    report = evaluate(session, data.name, [data.sequence("squares")], config, [Variant.FUSED])
    assert report.model_dump(mode="json")["rows"] == evaluated_copy.report["rows"]
    assert _contents(store) == before


def test_workers_give_the_same_keys_and_bytes_and_repair_as_well(evaluated, evaluated_copy, moseg, tmp_path):
    store = _open(evaluated_copy)
    tasks = {split_ref(ref)[0] for ref in store.refs()}
    _drop(store, tasks - {"frame", "annotation", "ingest"})
    ref = sorted(store.refs("frame"))[0]
    _flip(_files(evaluated_copy, ref)[0])
    report = _run(moseg, evaluated_copy, tmp_path, "--workers", "2")
    assert report["rows"] == evaluated.report["rows"]
    assert _contents(store) == _contents(_open(evaluated))
    assert _quarantined(evaluated_copy) == [ref]


def _start(evaluation, store, *more, env=None):
    arguments = [*MOSEG, *evaluation.arguments, "--store", str(store), *map(str, more)]
    return subprocess.Popen(arguments, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_a_killed_run_is_resumed_from_its_stored_artifacts(evaluated, moseg, strike_at, tmp_path):
    step = "event == 'os.rename' and '/objects/saliency/' in str(arguments[1])"
    env, _ = strike_at(step, "os.kill(os.getpid(), signal.SIGKILL)", in_worker=False, steps=3)
    run = _start(evaluated, tmp_path / "store", env=env)
    run.communicate(timeout=DEADLINE_SEC)
    assert run.returncode == -signal.SIGKILL

    resumed = evaluated._replace(store=tmp_path / "store")
    store = _open(resumed)
    assert all(result.is_intact for result in store.verify())
    committed = {ref: store.manifest(ref) for ref in store.refs()}
    report = _run(moseg, resumed, tmp_path)
    assert report["rows"] == evaluated.report["rows"]
    assert _contents(store) == _contents(_open(evaluated))
    assert {ref: store.manifest(ref) for ref in committed} == committed
    new = [ref for ref in store.refs() if ref not in committed]
    assert 0 < report["store"]["computed"] == len(new)
