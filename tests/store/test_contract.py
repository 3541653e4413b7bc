"""The laws of every artifact store, run on each kind of store."""

import pickle
import time
from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar

import numpy as np
import obstore
import pytest

from moseg.schemas.errors import CorruptArtifactError, InputError, MissingArtifactError, StoreError
from moseg.schemas.manifests import FileEntry
from moseg.schemas.recipes import Recipe
from moseg.store import ArtifactStore, LocalStore, PutOutcome, collection, copying, open_store, reading
from moseg.store.names import MANIFEST, slot
from moseg.store.packing import PACK, places
from moseg.store.remote.connection import connect
from moseg.store.remote.layout import manifest_name, payload_folder

RECIPE = Recipe(task="toy", version=2, params={"gap": 3}, inputs={"frame": "frame/" + "0" * 64})
MASKS = np.arange(4 * 5 * 6, dtype=np.uint16).reshape(4, 5, 6)
SCORES = np.array([0.5, -0.0, np.nan, np.inf])
ARRAYS = {"masks": MASKS, "scores": SCORES}
DIMS = {"masks": ("frame", "y", "x"), "scores": ("object",)}
ABSENT = "toy/" + "f" * 64


class StoreContract(ABC):
    """Laws of a store; a subclass ``Test…`` defines how to open one and how to reach its bytes without it."""

    without_manifest: ClassVar[list[bool]] = [False]
    """Result of `verify` for an artifact that has lost its manifest."""

    @abstractmethod
    def open(self, tmp_path: Path) -> ArtifactStore:
        """Return a store in this folder, the same one at each call."""

    @abstractmethod
    def files(self, store: ArtifactStore, ref: str) -> list[str]:
        """Return the names of the files of one artifact."""

    @abstractmethod
    def read_raw(self, store: ArtifactStore, ref: str, name: str) -> bytes:
        """Return the content of a file."""

    @abstractmethod
    def write_raw(self, store: ArtifactStore, ref: str, name: str, content: bytes | None) -> None:
        """Replace a file, or delete it if `content` is None."""

    def damage(self, store: ArtifactStore, ref: str, path: str, content: bytes | None) -> None:
        """Replace one of Zarr's files, or delete it if `content` is None: in a pack it has zeros then."""
        if PACK not in self.files(store, ref):
            self.write_raw(store, ref, path, content)
            return
        start, nbytes = places(store.manifest(ref).files)[path]
        packed = self.read_raw(store, ref, PACK)
        content = bytes(nbytes) if content is None else content
        self.write_raw(store, ref, PACK, packed[:start] + content + packed[start + nbytes :])

    @pytest.fixture
    def store(self, tmp_path: Path) -> ArtifactStore:
        return self.open(tmp_path)

    @pytest.fixture
    def ref(self, store: ArtifactStore) -> str:
        assert store.put(RECIPE, ARRAYS, {"count": 7}, seconds=0.25, dims=DIMS) is PutOutcome.COMMITTED
        return RECIPE.ref

    def test_store_has_the_interface(self, store):
        assert isinstance(store, ArtifactStore)

    def test_has_only_what_was_put(self, store, ref):
        assert store.has(ref)
        assert not store.has(ABSENT)

    def test_present_returns_the_stored_references(self, store, ref):
        assert store.present([ABSENT, ref, ref]) == {ref}
        assert store.present([]) == set()

    def test_read_returns_the_bytes_that_were_put(self, store, ref):
        for name, array in ARRAYS.items():
            found = store.read(ref, name)
            assert found.dtype == array.dtype and found.shape == array.shape
            assert found.tobytes() == array.tobytes()

    def test_read_returns_a_copy(self, store, ref):
        store.read(ref, "masks")[...] = 0
        assert store.read(ref, "masks").tobytes() == MASKS.tobytes()

    def test_put_does_not_change_its_input(self, store):
        array = MASKS.copy()
        array.flags.writeable = False
        store.put(RECIPE, {"masks": array}, dims={"masks": DIMS["masks"]})
        assert np.array_equal(array, MASKS)

    @pytest.mark.parametrize(("start", "stop"), [(0, 4), (1, 3), (3, 4), (2, 2), (0, 0), (4, 4)])
    @pytest.mark.parametrize("name", ["masks", "scores"])
    def test_read_rows_is_a_slice_of_read(self, store, ref, name, start, stop):
        assert store.read_rows(ref, name, start, stop).tobytes() == ARRAYS[name][start:stop].tobytes()

    @pytest.mark.parametrize(("start", "stop"), [(-1, 2), (3, 2), (0, 5)])
    def test_rows_outside_the_array_are_bad_input(self, store, ref, start, stop):
        with pytest.raises(InputError, match="rows"):
            store.read_rows(ref, "masks", start, stop)

    def test_manifest_describes_the_contents_and_their_origin(self, store, ref):
        manifest = store.manifest(ref)
        assert manifest.key == RECIPE.key and manifest.recipe == RECIPE and manifest.recipe.ref == ref
        assert manifest.array("masks").shape == MASKS.shape
        assert manifest.array("masks").dims == DIMS["masks"]
        assert manifest.array("scores").dtype == "<f8"
        assert manifest.seconds == 0.25
        assert manifest.nbytes == sum(file.nbytes for file in manifest.files)
        assert {"python", "numpy", "zarr"} <= manifest.versions.keys()
        assert store.attributes(ref) == {"count": 7}

    def test_artifact_without_arrays_keeps_its_attributes(self, store):
        recipe = Recipe(task="score", version=1)
        attributes = {"F": 0.1 + 0.2, "big": 2**60, "names": ["a", None, True], "nested": {"x": -0.0}}
        store.put(recipe, {}, attributes, dims={})
        assert repr(store.attributes(recipe.ref)) == repr(attributes)

    @pytest.mark.parametrize("value", [float("nan"), float("inf"), {1, 2}, np.float64(1.0), {1: 2}])
    def test_attributes_that_json_cannot_represent_are_refused(self, store, value):
        with pytest.raises((TypeError, ValueError)):
            store.put(RECIPE, ARRAYS, {"value": value}, dims=DIMS)
        assert not store.has(RECIPE.ref)

    def test_put_twice_keeps_the_first(self, store, ref):
        created = store.manifest(ref).created
        other = {"masks": MASKS + 1, "scores": SCORES}
        assert store.put(RECIPE, other, {"count": 8}, dims=DIMS) is PutOutcome.LOST_RACE
        assert store.read(ref, "masks").tobytes() == MASKS.tobytes()
        assert store.manifest(ref).created == created

    def test_put_that_loses_the_race_at_the_last_moment_is_a_success(self, store, ref, monkeypatch):
        monkeypatch.setattr(type(store), "has", lambda self, ref: False)
        assert store.put(RECIPE, {"masks": MASKS + 1, "scores": SCORES}, dims=DIMS) is PutOutcome.LOST_RACE
        assert store.read(ref, "masks").tobytes() == MASKS.tobytes()
        assert [result.is_intact for result in store.verify()] == [True]

    def test_every_array_has_axis_names(self, store):
        with pytest.raises(StoreError, match="axis names"):
            store.put(RECIPE, ARRAYS)

    @pytest.mark.parametrize(
        "array", [np.array(["a"]), np.array([None]), np.array(["2020"], dtype="M8[s]"), np.zeros(1, np.longdouble)]
    )
    def test_dtypes_without_portable_bytes_are_refused(self, store, array):
        with pytest.raises(StoreError, match="dtype"):
            store.put(RECIPE, {"x": array}, dims={"x": ("object",)})

    def test_a_chunk_over_two_gibibytes_is_refused(self, store):
        with pytest.raises(StoreError, match="too large"):
            store.put(RECIPE, {"x": np.broadcast_to(np.uint8(0), 2**31)}, dims={"x": ("object",)})

    @pytest.mark.parametrize(
        "dims", [{}, {"x": ("a",)}, {"x": ("a", "b"), "y": ("a",)}, {"masks": ("frame",), "scores": ("object",)}]
    )
    def test_axis_names_must_fit_the_arrays(self, store, dims):
        with pytest.raises(StoreError, match="axis names"):
            store.put(RECIPE, ARRAYS, dims=dims)

    def test_absent_artifact_is_a_key_error(self, store):
        for read in (store.manifest, store.attributes, lambda ref: store.read(ref, "masks")):
            with pytest.raises(MissingArtifactError, match="f" * 64):
                read(ABSENT)
        with pytest.raises(KeyError):
            list(store.verify([ABSENT]))

    def test_the_error_for_an_absent_array_lists_the_stored_ones(self, store, ref):
        with pytest.raises(StoreError, match="masks, scores"):
            store.read(ref, "flow")

    @pytest.mark.parametrize("bad", ["", "toy", "toy/0", "../" + "0" * 64, "toy/" + "A" * 64, "toy/" + "0" * 64 + "\n"])
    def test_malformed_reference_is_bad_input(self, store, bad):
        for call in (store.has, store.manifest, store.remove, lambda ref: store.quarantine(ref, "no reason")):
            with pytest.raises(InputError, match="reference"):
                call(bad)

    def test_refs_are_listed_in_order_and_by_task(self, store, ref):
        others = [Recipe(task=task, version=number) for task in ("apple", "zoo") for number in range(3)]
        for recipe in others:
            store.put(recipe, {}, dims={})
        assert list(store.refs()) == sorted([ref, *(recipe.ref for recipe in others)])
        assert list(store.refs("zoo")) == sorted(recipe.ref for recipe in others[3:])
        assert list(store.refs("nothing")) == []

    def test_usage_counts_artifacts_and_bytes_by_task(self, store, ref):
        store.put(Recipe(task="apple", version=1), {}, dims={})
        usage = store.usage()
        assert usage.keys() == {"apple", "toy"}
        assert usage["toy"].num_artifacts == 1
        assert usage["toy"].nbytes > store.manifest(ref).nbytes

    def test_removed_artifact_is_gone_and_can_be_put_again(self, store, ref):
        assert store.remove(ref) and not store.remove(ref)
        assert not store.has(ref) and list(store.refs()) == []
        assert store.put(RECIPE, ARRAYS, dims=DIMS) is PutOutcome.COMMITTED

    def test_quarantined_artifact_is_a_miss_and_can_be_put_again(self, store, ref):
        assert store.quarantine(ref, "bad bytes")
        assert not store.quarantine(ref, "bad bytes")
        assert not store.has(ref)
        with pytest.raises(MissingArtifactError):
            store.manifest(ref)
        assert store.put(RECIPE, ARRAYS, dims=DIMS) is PutOutcome.COMMITTED

    def test_store_can_be_pickled(self, store, ref):
        copy = pickle.loads(pickle.dumps(store))
        assert copy.read(ref, "masks").tobytes() == MASKS.tobytes()

    def test_another_handle_sees_the_artifact(self, store, ref, tmp_path):
        assert self.open(tmp_path).has(ref)

    def test_verify_passes_intact_artifacts(self, store, ref):
        store.put(Recipe(task="apple", version=1), {}, {"a": 1}, dims={})
        assert [(result.ref, result.problem) for result in store.verify(store.refs())] == [
            (ref, None) for ref in store.refs()
        ]

    @pytest.mark.parametrize("whole_bytes", [0, 65_536])
    def test_a_lost_chunk_is_never_read_as_zeros(self, store, ref, monkeypatch, whole_bytes):
        monkeypatch.setattr(reading, "WHOLE_BYTES", whole_bytes)
        contents = store.export_artifact(ref).files
        chunks = [name for name in contents if "/c" in name]
        assert len(chunks) == 5
        for name in chunks:
            self.damage(store, ref, name, None)
            with pytest.raises(CorruptArtifactError) as caught:
                store.read(ref, name.partition("/")[0])
            assert caught.value.ref == ref
            self.damage(store, ref, name, contents[name])

    def test_read_rows_needs_only_the_chunks_of_those_rows(self, store, ref, monkeypatch):
        monkeypatch.setattr(reading, "WHOLE_BYTES", 0)
        self.damage(store, ref, "masks/c.3.0.0", None)
        assert np.array_equal(store.read_rows(ref, "masks", 0, 3), MASKS[:3])
        with pytest.raises(CorruptArtifactError):
            store.read_rows(ref, "masks", 2, 4)

    def test_damage_to_any_file_is_found(self, store, ref):
        for name in self.files(store, ref):
            content = self.read_raw(store, ref, name)
            flipped = bytes([content[0] ^ 1]) + content[1:]
            for damaged in (None, b"", content[:-1], content + b"\0", flipped, bytes(len(content))):
                self.write_raw(store, ref, name, damaged)
                is_lost = name == MANIFEST and damaged is None
                expected = self.without_manifest if is_lost else [False]
                assert [result.is_intact for result in store.verify()] == expected, (name, damaged)
            self.write_raw(store, ref, name, content)
        assert [result.is_intact for result in store.verify()] == [True]

    def test_checked_read_finds_a_chunk_of_another_artifact(self, store, ref):
        other = Recipe(task="toy", version=3)
        store.put(other, {"masks": MASKS[::-1], "scores": SCORES}, dims=DIMS)
        self.damage(store, ref, "masks/c.0.0.0", store.export_artifact(other.ref).files["masks/c.0.0.0"])
        with pytest.raises(CorruptArtifactError):
            store.read(ref, "masks", check=True)
        assert store.read(other.ref, "masks", check=True).tobytes() == MASKS[::-1].tobytes()

    def test_an_artifact_is_copied_with_its_whole_manifest(self, store, ref, tmp_path):
        elsewhere = LocalStore(tmp_path / "elsewhere")
        exported = store.export_artifact(ref)
        assert elsewhere.import_artifact(exported) is PutOutcome.COMMITTED
        assert elsewhere.manifest(ref) == store.manifest(ref)
        assert elsewhere.export_artifact(ref) == exported
        assert [result.is_intact for result in elsewhere.verify()] == [True]
        assert store.import_artifact(elsewhere.export_artifact(ref)) is PutOutcome.LOST_RACE
        store.remove(ref)
        assert store.import_artifact(elsewhere.export_artifact(ref)) is PutOutcome.COMMITTED
        assert store.read(ref, "masks", check=True).tobytes() == MASKS.tobytes()
        assert store.manifest(ref) == elsewhere.manifest(ref)
        assert [result.is_intact for result in store.verify()] == [True]

    def test_a_damaged_artifact_is_not_exported(self, store, ref):
        for name in self.files(store, ref):
            content = self.read_raw(store, ref, name)
            for damaged in (None, content[:-1], bytes([content[0] ^ 1]) + content[1:]):
                self.write_raw(store, ref, name, damaged)
                with pytest.raises((CorruptArtifactError, MissingArtifactError)):
                    store.export_artifact(ref)
            self.write_raw(store, ref, name, content)
        with pytest.raises(MissingArtifactError):
            store.export_artifact(ABSENT)

    def test_a_changed_or_misplaced_file_is_not_imported(self, store, ref):
        exported = store.export_artifact(ref)
        store.remove(ref)
        chunk = exported.files["masks/c.0.0.0"]
        for files in (
            exported.files | {"masks/c.0.0.0": chunk[:-1]},
            exported.files | {"masks/c.0.0.0": bytes([chunk[0] ^ 1]) + chunk[1:]},
            exported.files | {"zarr.json": exported.files["zarr.json"].upper()},
            exported.files | {"../../escaped": b""},
            {path: content for path, content in exported.files.items() if path != "zarr.json"},
        ):
            listed = tuple(FileEntry(path=path, nbytes=len(content)) for path, content in files.items())
            for manifest in (exported.manifest, exported.manifest.model_copy(update={"files": listed})):
                with pytest.raises(CorruptArtifactError):
                    store.import_artifact(exported._replace(manifest=manifest, files=files))
        assert not store.has(ref)
        other = exported.manifest.model_copy(update={"key": "0" * 64})
        with pytest.raises(CorruptArtifactError, match="recipe"):
            store.import_artifact(exported._replace(manifest=other))

    def test_pins_are_listed_until_unpinned(self, store, ref):
        store.pin("run-1", [ref, ABSENT])
        assert store.pinned()["run-1"].refs == (ref, ABSENT)
        assert store.pin_of("run-1") == store.pinned()["run-1"] and store.pin_of("run-2") is None
        assert store.unpin("run-1") and not store.unpin("run-1")
        assert store.pinned() == {}

    def test_the_url_opens_the_same_store(self, store, ref):
        assert open_store(store.url, create=False).has(ref)

    def test_a_log_keeps_its_lines_in_order(self, store):
        before = time.time()
        store.append_log("run-1", b"one\ntwo\n")
        store.append_log("run-1", b"three\n")
        store.append_log("run-2", b"other\n")
        assert store.read_log("run-1") == [b"one", b"two", b"three"]
        assert store.logs().keys() == {"run-1", "run-2"}
        assert before - 60 < store.logs()["run-1"] < before + 600
        assert store.remove_log("run-1") and not store.remove_log("run-1")
        assert store.logs().keys() == {"run-2"} and store.read_log("run-1") == []

    @pytest.mark.parametrize("bad", ["", "../run", "a/b", ".", "x" * 101])
    def test_only_a_run_name_names_a_log(self, store, bad):
        for call in (store.read_log, store.remove_log, lambda name: store.append_log(name, b"line\n")):
            with pytest.raises(InputError, match="run"):
                call(bad)

    def test_gc_keeps_all_that_a_pin_reaches(self, store, ref):
        recipes = [RECIPE]
        for number in range(3):
            recipes.append(Recipe(task="toy", version=number, inputs={"previous": recipes[-1].ref}))
            store.put(recipes[-1], {}, dims={})
        store.pin("run-1", [recipes[2].ref])
        assert store.gc(is_dry=False, grace_seconds=60).removed == ()
        assert store.gc(is_dry=False, grace_seconds=0).removed == (recipes[3].ref,)
        assert set(store.refs()) == {recipe.ref for recipe in recipes[:3]}

    def test_artifacts_that_a_run_pins_during_the_sweep_are_restored(self, store, ref, monkeypatch):
        pins_seen = []

        def pinned_late(backend):
            pins_seen.append(store.pinned())
            if len(pins_seen) == 2:
                store.pin("late", [ref])
            return store.pinned() if len(pins_seen) == 2 else pins_seen[0]

        other = Recipe(task="apple", version=1)
        store.put(other, {}, dims={})
        monkeypatch.setattr(collection, "pinned", pinned_late)
        assert store.gc(is_dry=False, grace_seconds=0).removed == (other.ref,)
        assert list(store.refs()) == [ref]
        assert [result.is_intact for result in store.verify()] == [True]

    def test_a_failed_sweep_restores_everything(self, store, ref, monkeypatch):
        calls = iter([{}, StoreError("unreadable pin")])

        def pinned(backend):
            answer = next(calls)
            if isinstance(answer, StoreError):
                assert not store.has(ref)
                raise answer
            return answer

        monkeypatch.setattr(collection, "pinned", pinned)
        with pytest.raises(StoreError, match="unreadable pin"):
            store.gc(is_dry=False, grace_seconds=0)
        assert [result.is_intact for result in store.verify([ref])] == [True]

    def test_gc_without_a_pin_previews_what_it_deletes(self, store, ref):
        store.pin("run-1", [ref])
        preview = store.gc(grace_seconds=0, forget=["run-1"])
        assert preview.removed == (ref,) and store.has(ref) and "run-1" in store.pinned()
        done = store.gc(is_dry=False, grace_seconds=0, forget=["run-1"])
        assert done.removed == preview.removed and done.nbytes == preview.nbytes
        assert list(store.refs()) == [] and store.pinned() == {}

    def test_gc_to_a_size_removes_no_more_than_needed(self, store, ref):
        others = [Recipe(task="toy", version=number) for number in (3, 4)]
        for recipe in others:
            store.put(recipe, ARRAYS, dims=DIMS)
        store.pin("run-1", [ref])
        total = sum(use.nbytes for use in store.usage().values())
        assert store.gc(is_dry=False, grace_seconds=0, keep_nbytes=total).removed == ()
        report = store.gc(is_dry=False, grace_seconds=0, keep_nbytes=total - 1)
        assert len(report.removed) == 1 and report.removed[0] != ref
        assert report.left == sum(use.nbytes for use in store.usage().values())
        assert store.gc(is_dry=False, grace_seconds=0, keep_nbytes=0).left > 0
        assert list(store.refs()) == [ref]

    def test_touch_is_no_error_without_an_artifact(self, store, ref):
        store.touch([ref, ABSENT])
        assert list(store.refs()) == [ref]

    def test_a_pin_without_inputs_keeps_only_what_it_names(self, store, ref):
        child = Recipe(task="apple", version=1, inputs={"toy": ref})
        store.put(child, {}, dims={})
        store.pin("run-1", [child.ref], run="a run", with_inputs=False)
        assert store.pin_of("run-1").run == "a run"
        assert store.gc(grace_seconds=0).removed == (ref,)
        assert store.release([ref, child.ref, ABSENT]) == 1
        assert list(store.refs()) == [child.ref]

    def test_gc_deletes_what_no_pin_reaches(self, store, ref):
        other = Recipe(task="apple", version=1)
        store.put(other, {}, dims={})
        store.pin("run-1", [ref])
        assert store.gc(grace_seconds=0).removed == (other.ref,)
        assert store.has(other.ref)
        report = store.gc(is_dry=False, grace_seconds=0)
        assert report.removed == (other.ref,) and report.num_kept == 1 and report.nbytes > 0
        assert list(store.refs()) == [ref]


class TestLocalStore(StoreContract):
    def open(self, tmp_path):
        return LocalStore(tmp_path / "a store with blanks, ü and 動き")

    def files(self, store, ref):
        folder = self._folder(store, ref)
        return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())

    def read_raw(self, store, ref, name):
        return (self._folder(store, ref) / name).read_bytes()

    def write_raw(self, store, ref, name, content):
        path = self._folder(store, ref) / name
        path.unlink(missing_ok=True)
        if content is not None:
            path.write_bytes(content)

    @staticmethod
    def _folder(store, ref):
        task, key = ref.split("/")
        return store.root / "objects" / task / key[:2] / key


class TestSeparateFiles(TestLocalStore):
    """Artifacts in files of their own, as those that are too large for a pack and those of earlier versions."""

    @pytest.fixture(autouse=True)
    def unpacked(self, monkeypatch):
        monkeypatch.setattr(copying, "is_packable", lambda files: False)


class TestRemoteStore(StoreContract):
    """The contract on an S3 server; the bytes are reached by plain requests of the client, without the store."""

    without_manifest: ClassVar[list[bool]] = []

    @pytest.fixture(autouse=True)
    def server(self, s3):
        self.url = s3
        self.payloads: dict[str, str] = {}

    def open(self, tmp_path):
        return open_store(self.url)

    def files(self, store, ref):
        folder = self._payload(ref)
        names = [item["path"].removeprefix(f"{folder}/") for item in obstore.list(self._client(), folder).collect()]
        return [MANIFEST, *sorted(names)]

    def read_raw(self, store, ref, name):
        return obstore.get(self._client(), self._name(ref, name)).bytes().to_bytes()

    def write_raw(self, store, ref, name, content):
        if content is None:
            obstore.delete(self._client(), self._name(ref, name))
        else:
            obstore.put(self._client(), self._name(ref, name), content)

    def _client(self):
        return connect(self.url)

    def _name(self, ref, name):
        return manifest_name(ref) if name == MANIFEST else f"{self._payload(ref)}/{name}"

    def _payload(self, ref):
        # also while a test has deleted a file
        for item in obstore.list(self._client(), f"payloads/{slot(ref)}").collect():
            self.payloads[ref] = item["path"].split("/")[4]
        return payload_folder(ref, self.payloads[ref])
