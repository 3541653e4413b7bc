"""Many clips of trajectories are computed one a call: with the same results, and artifact by artifact all the same."""

import json

import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.recipes import Recipe
from moseg.store import open_store
from moseg.workflows.cluster.runners import SynchronousRunner
from moseg.workflows.runlog.status import list_runs, read_status
from moseg.workflows.stages import registry
from moseg.workflows.stages.array_cache import ARRAYS

pytestmark = pytest.mark.usefixtures("in_empty_folder")

NAMES = (
    *("Seq005_Clip01", "Seq005_Clip02", "Seq009_Clip01", "Seq009_Clip02", "Seq009_Clip03", "Seq011_Clip01"),
    *("Seq013_Clip01", "Seq013_Clip02"),
)
"""As many clips as one process must have for one call each."""
OF_A_CLIP = 9
"""Artifacts of a clip with three views, without its leaves."""
OPTIONS = ("--dataset", "kt3dmoseg", "--motions", "gt", "--set", "hypotheses.num_hypotheses=50", "--quiet")


@pytest.fixture(scope="module")
def many(write_clip, tmp_path_factory):
    """Root of a data set of as many clips."""
    root = tmp_path_factory.mktemp("many")
    for seed, name in enumerate(NAMES):
        write_clip(root / f"{name}_Tracks.mat", seed)
    return root


@pytest.fixture
def drawn(monkeypatch):
    """Numbers of recipes of the calls that this process runs, in lists; ingest apart."""
    found: list[int] = []
    run = SynchronousRunner.run

    def draw(calls):
        for call in calls:
            if not call.name.startswith("ingest"):
                found.append(sum(1 if isinstance(part, Recipe) else len(part) for part in call.arguments[1]))
            yield call

    monkeypatch.setattr(SynchronousRunner, "run", lambda self, calls, on_done: run(self, draw(calls), on_done))
    return found


def _evaluate(moseg, root, store, *options):
    report = store.parent / "report.json"
    ran = moseg("eval", "--root", root, "--store", store, "--json", report, *OPTIONS, *options)
    assert ran.code == 0, ran.err
    return json.loads(report.read_text())


def _manifests(path):
    store = open_store(str(path))
    found = {ref: store.manifest(ref) for ref in store.refs()}
    return {ref: (manifest.arrays, manifest.attributes) for ref, manifest in found.items()}


def test_many_clips_take_one_call_each_and_give_what_they_give_alone(many, moseg, tmp_path, drawn):
    together = _evaluate(moseg, many, tmp_path / "together")
    # The arrays of a clip leave memory with its call.
    store = open_store(str(tmp_path / "together"))
    arrays = [(ref, array.name) for ref in store.refs() for array in store.manifest(ref).arrays]
    assert arrays and all(ARRAYS.find(store.url, *each) is None for each in arrays)
    assert drawn == [OF_A_CLIP] * len(NAMES)
    assert together["store"]["computed"] == len(NAMES) * (OF_A_CLIP + 2)
    drawn.clear()
    for name in NAMES:
        _evaluate(moseg, many, tmp_path / "alone", "--sequences", name)
    assert drawn == [1] * OF_A_CLIP * len(NAMES)
    assert _manifests(tmp_path / "together") == _manifests(tmp_path / "alone")


def test_one_worker_gives_the_same_bytes_for_many_clips(many, moseg, tmp_path):
    _evaluate(moseg, many, tmp_path / "here")
    _evaluate(moseg, many, tmp_path / "there", "--workers", "1")
    assert _manifests(tmp_path / "here") == _manifests(tmp_path / "there")


def test_a_clip_that_failed_goes_on_from_its_first_missing_artifact(many, moseg, tmp_path, monkeypatch):
    computed: list[str] = []
    find_task = registry.find_task

    class Failing:
        """A task that fails in the third clip."""

        def __init__(self, task):
            self._task = task

        def compute(self, params, inputs, generators):
            computed.append(self._task.name)
            if computed.count("trajectory_clustering") == 3:
                raise InputError("a fault of the third clip")
            return self._task.compute(params, inputs, generators)

    arguments = ("--root", many, "--store", tmp_path / "store", *OPTIONS)
    with monkeypatch.context() as patch:
        found = "moseg.workflows.engine.execution.find_task"
        patch.setattr(found, lambda name, method: Failing(find_task(name, method)))
        ran = moseg("eval", *arguments)
    assert ran.code == 2 and "a fault of the third clip" in ran.err
    store = open_store(str(tmp_path / "store"))
    (failure,) = read_status(store, list_runs(store)[0]).failures
    assert failure.ref.startswith("trajectory_clustering/")
    done = len(list(store.refs()))
    # Of the third clip all but the clustering and the score is there.
    again = _evaluate(moseg, many, tmp_path / "store")
    assert again["store"]["computed"] == len(NAMES) * OF_A_CLIP - (2 * OF_A_CLIP + OF_A_CLIP - 2)
    assert done + again["store"]["computed"] == len(list(store.refs()))
