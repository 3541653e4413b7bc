"""Copying artifacts between stores: verified, resumable, inputs first."""

import json
import os
import shutil
import signal
import subprocess
import sys

import numpy as np
import obstore
import pytest
import zarr

from moseg.schemas.errors import StoreError
from moseg.store import LocalStore, open_store
from moseg.store.reading import read_sealed
from moseg.store.remote.connection import connect
from moseg.store.sealing import seal
from moseg.store.transfer import is_same_store, keep, kept_meanwhile, plan_transfer, select, transfer

DIES = """
import os, signal, sys
from moseg.store import LocalStore
from moseg.store.transfer import plan_transfer, select, transfer

source, target = map(LocalStore, sys.argv[1:])
done = []

def die(ref):
    done.append(ref)
    if len(done) == 3:
        os.kill(os.getpid(), signal.SIGKILL)

transfer(source, target, plan_transfer(source, target, select(source)), die)
"""


@pytest.fixture
def family(store, put_toy):
    """Put two leaves, their child, its child, and a separate artifact in the source; return references by name."""
    refs = {"left": put_toy(store, 0), "right": put_toy(store, 1), "apart": put_toy(store, 9)}
    refs["child"] = put_toy(store, 2, {"pair": (refs["left"], refs["right"])})
    refs["grandchild"] = put_toy(store, 3, {"child": refs["child"], "leaf": refs["left"]})
    return refs


@pytest.fixture
def target(tmp_path):
    return LocalStore(tmp_path / "target")


@pytest.fixture(params=["a folder", "an object store"])
def other(request, tmp_path):
    """Return a store of each kind."""
    return LocalStore(tmp_path / "other") if request.param == "a folder" else open_store(request.getfixturevalue("s3"))


class _Watched:
    """A target that calls `look` with each reference before it imports the artifact."""

    def __init__(self, store, look):
        self._store, self._look = store, look

    def __getattr__(self, name):
        return getattr(self._store, name)

    def import_artifact(self, artifact):
        self._look(artifact.manifest.recipe)
        return self._store.import_artifact(artifact)


def _copy(source, target, roots=None, **options):
    plan = plan_transfer(source, target, select(source, roots))
    return transfer(source, target, plan, **options)


def _damage(store, ref):
    task, key = ref.split("/")
    path = store.root / "objects" / task / key[:2] / key / "arrays.zip"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def test_an_artifact_copied_there_and_back_is_the_same(store, family, other, tmp_path):
    back = LocalStore(tmp_path / "back")
    for source, target in ((store, other), (other, back)):
        report = _copy(source, target)
        assert (report.num_copied, report.num_present, report.problems) == (len(family), 0, {})
        assert report.nbytes == sum(store.manifest(ref).nbytes for ref in family.values())
    assert list(back.refs()) == list(other.refs()) == list(store.refs())
    for ref in family.values():
        assert back.manifest(ref) == other.manifest(ref) == store.manifest(ref)
        np.testing.assert_array_equal(back.read(ref, "x", check=True), store.read(ref, "x"))
    assert all(result.is_intact for each in (other, back) for result in each.verify())


def test_inputs_are_copied_before_their_descendants(store, put_toy, other):
    chain = [put_toy(store, 0)]
    for number in range(1, 12):
        chain.append(put_toy(store, number, {"last": chain[-1], "first": chain[0]}))
    for number in range(12, 24):
        put_toy(store, number, {"all": tuple(chain[: number - 11])})
    early = []

    def look(recipe):
        if other.present(recipe.input_refs()) != set(recipe.input_refs()):
            early.append(recipe.ref)

    assert _copy(store, _Watched(other, look), num_threads=4).num_copied == 24
    assert early == []


def test_artifacts_that_the_target_has_are_not_read(store, family, other):
    _copy(store, other, [family["child"]])
    _damage(store, family["left"])
    report = _copy(store, other)
    assert (report.num_copied, report.num_present, report.problems) == (2, 3, {})


def test_a_root_is_copied_with_its_ancestors(store, family, target):
    assert _copy(store, target, [family["child"]]).num_copied == 3
    assert set(target.refs()) == {family["left"], family["right"], family["child"]}


def test_a_root_is_copied_alone_without_inputs(store, family, target):
    selected = select(store, [family["grandchild"]], with_inputs=False)
    transfer(store, target, plan_transfer(store, target, selected))
    assert list(target.refs()) == [family["grandchild"]]


def test_artifacts_removed_at_the_source_are_ignored(store, family, target):
    store.remove(family["child"])
    report = _copy(store, target, [family["grandchild"]])
    assert (report.num_copied, report.problems) == (2, {})
    assert set(target.refs()) == {family["grandchild"], family["left"]}


def test_a_damaged_artifact_is_named_and_the_rest_is_copied(store, family, other):
    _damage(store, family["left"])
    report = _copy(store, other)
    assert report.num_copied == len(family) - 1
    assert list(report.problems) == [family["left"]]
    assert set(other.refs()) == {*family.values()} - {family["left"]}


def test_a_damaged_manifest_is_named_and_the_rest_is_copied(store, family, target):
    task, key = family["child"].split("/")
    manifest = store.root / "objects" / task / key[:2] / key / "manifest.json"
    manifest.write_bytes(manifest.read_bytes()[:-20])
    report = _copy(store, target)
    assert report.num_copied == len(family) - 1
    assert list(report.problems) == [family["child"]]
    assert "seal" in report.problems[family["child"]]


def test_forged_artifacts_that_are_inputs_of_each_other_are_named_and_the_rest_is_copied(store, family, target):
    forged = [family["left"], family["right"]]
    for ref, other in (forged, forged[::-1]):
        sealed = read_sealed(store, ref)
        recipe = sealed.manifest.recipe.about({"other": other})
        task, key = ref.split("/")
        data = seal(sealed.manifest.model_copy(update={"recipe": recipe}), sealed.metadata, is_packed=True)
        (store.root / "objects" / task / key[:2] / key / "manifest.json").write_bytes(data)
    report = _copy(store, target)
    assert report.num_copied == len(family) - 2
    assert report.problems.keys() == set(forged)
    assert all("another recipe" in problem for problem in report.problems.values())


def test_an_artifact_that_vanishes_while_it_is_copied_is_named(store, family, target):
    plan = plan_transfer(store, target, select(store))
    store.remove(family["apart"])
    report = transfer(store, target, plan)
    assert report.num_copied == len(family) - 1
    assert list(report.problems) == [family["apart"]]


def test_a_simultaneous_copy_by_another_process_is_no_error(store, family, target):
    plan = plan_transfer(store, target, select(store))
    _copy(store, target)
    report = transfer(store, target, plan)
    assert (report.num_copied, report.num_present, report.nbytes, report.problems) == (0, len(family), 0, {})


def test_a_killed_copy_leaves_nothing_incomplete_and_can_be_continued(store, family, put_toy, target):
    last = family["grandchild"]
    for number in range(20, 30):
        last = put_toy(store, number, {"last": last})
    num_all = len(list(store.refs()))
    ran = subprocess.run([sys.executable, "-c", DIES, store.root, target.root], check=False)
    assert ran.returncode == -signal.SIGKILL
    there = set(target.refs())
    # One more may have been started; of a chain, no more than one.
    assert 3 <= len(there) < num_all
    assert all(result.is_intact for result in target.verify())
    for ref in there:
        assert there.issuperset(target.manifest(ref).recipe.input_refs())
    report = _copy(store, target)
    assert (report.num_copied, report.num_present) == (num_all - len(there), len(there))
    assert set(target.refs()) == set(store.refs())


def test_an_interruption_ends_the_copy_at_once(store, put_toy, target):
    for number in range(100):
        put_toy(store, number)

    def interrupt(ref):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _copy(store, target, on_done=interrupt, num_threads=2)
    assert 1 <= len(list(target.refs())) <= 6
    assert all(result.is_intact for result in target.verify())


def test_a_target_that_cannot_be_written_ends_the_copy(store, family, target):
    plan = plan_transfer(store, target, select(store))
    shutil.rmtree(target.root / "objects", ignore_errors=True)
    (target.root / "objects").write_text("")
    with pytest.raises(StoreError):
        transfer(store, target, plan)


def test_each_artifact_is_reported_once(store, family, target):
    _damage(store, family["apart"])
    done = []
    _copy(store, target, on_done=done.append)
    assert sorted(done) == sorted(family.values())


def test_a_collection_at_the_target_keeps_artifacts_being_copied(store, family, target):
    with kept_meanwhile(target, select(store)):
        _copy(store, target)
        assert target.gc(is_dry=False, grace_seconds=0).removed == ()
    assert len(target.gc(is_dry=False, grace_seconds=0).removed) == len(family)


def test_a_kept_run_keeps_its_artifacts_at_the_target(store, family, target):
    _copy(store, target)
    keep(target, {"a-run": [family["child"]]})
    removed = target.gc(is_dry=False, grace_seconds=0).removed
    assert set(removed) == {family["apart"], family["grandchild"]}


def test_a_pin_at_the_target_keeps_its_earlier_references(family, target):
    target.pin("a-run", [family["apart"]])
    keep(target, {"a-run": [family["child"]]})
    assert target.pinned()["a-run"].refs == (family["apart"], family["child"])
    before = target.pinned()
    keep(target, {"a-run": [family["child"]]})
    assert target.pinned() == before


@pytest.mark.parametrize("there", [False, True])
@pytest.mark.parametrize("here", [False, True])
def test_a_pin_protects_inputs_if_either_store_does(store, family, target, there, here):
    store.pin("a-run", [family["child"]], with_inputs=here)
    target.pin("a-run", [family["child"]], with_inputs=there, run="named")
    keep(target, {"a-run": [family["child"]]}, store.pinned())
    pin = target.pinned()["a-run"]
    assert (pin.with_inputs, pin.run) == (there or here, "named")


def test_a_lease_of_the_same_name_becomes_a_lasting_pin(family, target):
    target.pin("a-run", [family["apart"]], lease_seconds=60)
    keep(target, {"a-run": [family["apart"]]})
    assert target.pinned()["a-run"].expires is None


def test_a_store_is_the_same_by_another_path(store, target, tmp_path):
    os.symlink(store.root, tmp_path / "link")
    assert is_same_store(store, LocalStore(tmp_path / "link"))
    assert not is_same_store(store, target)


def test_a_prefix_is_the_same_store_and_a_folder_is_another(store, s3):
    assert is_same_store(open_store(s3), open_store(f"{s3}/"))
    assert not is_same_store(store, open_store(s3))
    assert not is_same_store(open_store(s3), open_store(f"{s3}-other"))


def test_a_run_after_push_and_pull_computes_nothing(evaluated, pushed, s3, moseg, tmp_path):
    ran = moseg("store", "pull", pushed, "--quiet", "--store", tmp_path / "pulled")
    assert (ran.code, ran.err) == (0, "")
    ran = moseg(*evaluated.arguments, "--store", tmp_path / "pulled")
    assert ran.code == 0
    assert "0 artifacts computed" in ran.out


def test_the_commands_print_the_same_on_an_object_store_as_in_a_folder(evaluated, pushed, s3, moseg):
    stores = ("--store", evaluated.store), ("--store", pushed)
    assert len({moseg("store", "ls", *store).out for store in stores}) == 1
    assert len({moseg("store", "verify", "--quiet", *store) for store in stores}) == 1
    score = moseg("store", "ls", "--task", "score", *stores[0]).out.strip()
    here, there = (json.loads(moseg("store", "show", score, *store).out) for store in stores)
    assert here.pop("place") != there.pop("place")
    assert here == there


def test_the_place_of_an_artifact_on_an_object_store_opens_in_zarr(store, family, s3, tmp_path):
    remote = open_store(s3)
    _copy(store, remote)
    folder, _, name = remote.place(family["child"]).removeprefix("zip::").rpartition("/")
    (tmp_path / name).write_bytes(obstore.get(connect(folder), name).bytes().to_bytes())
    group = zarr.open_group(f"zip::{tmp_path / name}", mode="r")
    np.testing.assert_array_equal(group["x"][:], store.read(family["child"], "x"))


def test_damage_on_an_object_store_is_found_named_and_not_pulled(evaluated, moseg, s3, tmp_path):
    flow = moseg("store", "ls", "--task", "flow", "--store", evaluated.store).out.split()[0]
    assert moseg("store", "push", s3, flow, "--quiet", "--store", evaluated.store).code == 0
    where = json.loads(moseg("store", "show", flow, "--no-downstream", "--store", s3).out)["place"]
    folder, _, name = where.removeprefix("zip::").rpartition("/")
    connect(folder).delete(name)
    found = moseg("store", "verify", "--quiet", "--store", s3)
    assert found.code == 1
    assert found.out.startswith(f"{flow}: ")
    ran = moseg("store", "pull", s3, "--quiet", "--store", tmp_path / "pulled")
    assert ran.code == 1
    assert ran.out.startswith(f"{flow}: not copied: ")
