"""Kills, races and lost answers on an object store: an artifact is stored completely or not at all."""

import json
import subprocess
import sys
from collections import Counter

import numpy as np
import obstore
import pytest
from obstore.exceptions import AlreadyExistsError, GenericError, NotSupportedError

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.schemas.recipes import Recipe
from moseg.store import PutOutcome, copying, open_store
from moseg.store.packing import Range
from moseg.store.remote import requests as remote_requests
from moseg.store.remote.connection import connect
from moseg.store.remote.layout import manifest_name, payload_folder
from moseg.store.sealing import unseal

RECIPE = Recipe(task="toy", version=1)
DIMS = {"x": ("frame", "y", "x")}

VICTIMS = """
import json, os, random, signal, sys, time
import numpy as np
from moseg.schemas.recipes import Recipe
from moseg.store import open_store
from moseg.store.remote import requests

url, mode = sys.argv[1:]
ARRAY = np.arange(6 * 50 * 50, dtype=np.float32).reshape(6, 50, 50)


def put(number):
    recipe = Recipe(task="toy", version=1, params={"number": number})
    outcome = open_store(url).put(recipe, {"x": ARRAY + number}, {"number": number}, dims={"x": ("frame", "y", "x")})
    print(outcome, flush=True)


def die_at(step):
    steps = iter(range(1, 1000))

    def counted(call):
        def wrapped(*args, **kwargs):
            if next(steps) == step:
                os.kill(os.getpid(), signal.SIGKILL)
            return call(*args, **kwargs)

        return wrapped

    for name in ("put", "head", "get"):
        setattr(requests.obstore, name, counted(getattr(requests.obstore, name)))


def fork(victim):
    pid = os.fork()
    if pid == 0:
        try:
            victim()
        finally:
            os._exit(0)
    return pid


# nothing was asked before the fork, so that each victim has threads of its own
if mode == "steps":
    kills = 0
    while os.waitpid(fork(lambda: (die_at(kills + 1), put(kills))), 0)[1]:
        kills += 1
elif mode == "moments":
    rng = random.Random(0)
    kills = 0
    for trial in range(6):
        started, start = os.pipe()
        pid = fork(lambda: [(put(1000 * trial + n), os.write(start, b"x")) for n in range(1000)])
        for _ in range(rng.randint(1, 3)):
            os.read(started, 1)
        time.sleep(rng.uniform(0.0, 0.05))
        os.kill(pid, signal.SIGKILL)
        kills += os.waitpid(pid, 0)[1] != 0
else:
    gate, opener = os.pipe()
    ARRAY[:] = 0
    def race(number):
        open_store(url)
        os.close(opener)
        os.read(gate, 1)
        array = np.full_like(ARRAY, number)
        print(open_store(url).put(Recipe(task="toy", version=1), {"x": array}, dims={"x": ("frame", "y", "x")}))
        sys.stdout.flush()
    pids = [fork(lambda: race(number)) for number in range(6)]
    os.close(opener)
    kills = max(os.waitpid(pid, 0)[1] for pid in pids)
print(json.dumps(kills))
"""


def run_victims(url: str, mode: str) -> list[str]:
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", VICTIMS, url, mode]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def attempts(url: str) -> set[str]:
    return {"/".join(item["path"].split("/")[:5]) for item in obstore.list(connect(url), "payloads").collect()}


@pytest.mark.parametrize("mode", ["steps", "moments"])
def test_killed_writers_leave_complete_artifacts_or_none(s3, mode):
    *_, kills = run_victims(s3, mode)
    # of one put: the marker, a lookup, six chunks, two files of metadata, the manifest
    assert json.loads(kills) >= (4 if mode == "steps" else 6)
    store = open_store(s3)
    stored = list(store.refs())
    assert stored
    assert [result for result in store.verify() if not result.is_intact] == []
    array = np.arange(6 * 50 * 50, dtype=np.float32).reshape(6, 50, 50)
    for ref in stored[:20]:
        assert np.array_equal(store.read(ref, "x"), array + store.attributes(ref)["number"])

    orphans = len(attempts(s3)) - len(stored)
    assert orphans > 0 or mode == "moments"
    for number in range(10):
        recipe = Recipe(task="toy", version=1, params={"number": number})
        expected = PutOutcome.LOST_RACE if store.has(recipe.ref) else PutOutcome.COMMITTED
        assert store.put(recipe, {"x": array}, dims=DIMS) is expected
    report = store.gc(is_dry=False)
    assert len(report.leftovers) == orphans and report.removed == ()
    assert len(attempts(s3)) == len(list(store.refs()))
    assert [result for result in store.verify() if not result.is_intact] == []


def test_of_writers_of_different_bytes_one_wins_and_the_others_leave_nothing(s3):
    *outcomes, failed = run_victims(s3, "race")
    assert json.loads(failed) == 0
    assert Counter(outcomes) == {"committed": 1, "lost-race": 5}
    store = open_store(s3)
    array = store.read(RECIPE.ref, "x", check=True)
    assert (array == array.flat[0]).all()
    assert [result.is_intact for result in store.verify()] == [True]
    assert len(attempts(s3)) == 1


@pytest.fixture
def store(s3):
    return open_store(s3)


def put(store, value: float) -> PutOutcome:
    return store.put(RECIPE, {"x": np.full((2, 3, 4), value)}, dims=DIMS)


def as_if_absent(monkeypatch, store) -> None:
    """Make each put find that it is the first."""
    monkeypatch.setattr(type(store), "has", lambda self, ref: False)


def test_files_without_a_manifest_are_a_miss(store, s3):
    put(store, 1)
    obstore.delete(connect(s3), manifest_name(RECIPE.ref))
    assert not store.has(RECIPE.ref) and list(store.refs()) == [] and store.present([RECIPE.ref]) == set()
    with pytest.raises(MissingArtifactError):
        store.read(RECIPE.ref, "x")
    assert put(store, 2) is PutOutcome.COMMITTED
    assert (store.read(RECIPE.ref, "x", check=True) == 2).all()


def test_a_lost_answer_is_not_a_lost_race(store, monkeypatch):
    real = obstore.put

    def answer_lost(client, name, content, **options):
        real(client, name, content, **options)
        if options.get("mode") == "create":
            raise AlreadyExistsError("written by the first of two requests")

    monkeypatch.setattr(remote_requests.obstore, "put", answer_lost)
    assert put(store, 1) is PutOutcome.COMMITTED
    assert (store.read(RECIPE.ref, "x", check=True) == 1).all()


REFUSALS = [
    NotSupportedError("no conditions"),
    GenericError("PUT http://server/x - Server returned non-2xx status code: 501 Not Implemented: <Error></Error>"),
    GenericError("PUT http://server/x - status code: 400 Bad Request: <Error><Code>NotImplemented</Code></Error>"),
]


@pytest.mark.parametrize("refusal", [*REFUSALS, None])
def test_on_a_server_without_conditions_the_manifest_is_looked_up_first(s3, monkeypatch, refusal):
    real = obstore.put

    def refusing(client, name, content, **options):
        if options.get("mode") == "create":
            raise refusal
        return real(client, name, content, **options)

    if refusal is None:
        # the client's own option for such servers
        monkeypatch.setenv("AWS_CONDITIONAL_PUT", "disabled")
    else:
        monkeypatch.setattr(remote_requests.obstore, "put", refusing)
    store = open_store(s3)
    assert put(store, 1) is PutOutcome.COMMITTED
    as_if_absent(monkeypatch, store)
    assert put(store, 2) is PutOutcome.LOST_RACE
    assert (store.read(RECIPE.ref, "x", check=True) == 1).all()
    assert len(attempts(s3)) == 1


def test_on_a_server_that_ignores_conditions_the_last_wins_and_bytes_never_mix(store, s3, monkeypatch):
    real = obstore.put

    def ignoring(client, name, content, **options):
        options.pop("mode", None)
        return real(client, name, content, **options)

    monkeypatch.setattr(remote_requests.obstore, "put", ignoring)
    as_if_absent(monkeypatch, store)
    assert [put(store, value) for value in (1, 2)] == [PutOutcome.COMMITTED] * 2
    assert (store.read(RECIPE.ref, "x", check=True) == 2).all()
    assert [result.is_intact for result in store.verify()] == [True]
    assert len(attempts(s3)) == 2


def test_an_artifact_that_vanishes_while_it_is_read_is_missing_not_corrupt(store, s3):
    put(store, 1)
    payload = unseal(store.read_manifest(RECIPE.ref)).payload
    store.remove(RECIPE.ref)
    for _ in ("gone", "computed again"):
        with pytest.raises(MissingArtifactError):
            store.read_files(RECIPE.ref, payload, ["arrays.zip"])
        with pytest.raises(MissingArtifactError):
            store.read_ranges(RECIPE.ref, payload, "arrays.zip", 4, {"x/zarr.json": Range(0, 4)})
        with pytest.raises(MissingArtifactError):
            store.file_sizes(RECIPE.ref, payload)
        put(store, 2)


@pytest.mark.parametrize("payload", ["", "..", "elsewhere"])
def test_a_manifest_that_names_no_attempt_is_damage(store, payload):
    put(store, 1)
    with pytest.raises(CorruptArtifactError):
        store.read_files(RECIPE.ref, payload, ["zarr.json"])


def test_zarr_alone_reads_separate_files(store, s3, monkeypatch):
    zarr = pytest.importorskip("zarr")
    monkeypatch.setattr(copying, "is_packable", lambda files: False)
    put(store, 3)
    payload = unseal(store.read_manifest(RECIPE.ref)).payload
    client = connect(f"{s3}/{payload_folder(RECIPE.ref, payload)}")
    group = zarr.open_group(zarr.storage.ObjectStore(client, read_only=True), mode="r")
    assert (group["x"][...] == 3).all()
