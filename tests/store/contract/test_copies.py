"""Copies of artifacts from and to every kind of store: whole and verified."""

import pytest

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.schemas.manifests import FileEntry
from moseg.store import LocalStore, PutOutcome

ABSENT = "toy/" + "f" * 64


def test_an_artifact_is_copied_with_its_whole_manifest(store, ref, toy, tmp_path):
    elsewhere = LocalStore(tmp_path / "elsewhere")
    exported = store.export_artifact(ref)
    assert elsewhere.import_artifact(exported) is PutOutcome.COMMITTED
    assert elsewhere.manifest(ref) == store.manifest(ref)
    assert elsewhere.export_artifact(ref) == exported
    assert [result.is_intact for result in elsewhere.verify()] == [True]
    assert store.import_artifact(elsewhere.export_artifact(ref)) is PutOutcome.LOST_RACE
    store.remove(ref)
    assert store.import_artifact(elsewhere.export_artifact(ref)) is PutOutcome.COMMITTED
    assert store.read(ref, "masks", check=True).tobytes() == toy.masks.tobytes()
    assert store.manifest(ref) == elsewhere.manifest(ref)
    assert [result.is_intact for result in store.verify()] == [True]


def test_a_damaged_artifact_is_not_exported(store, place, ref):
    for name in place.files(ref):
        content = place.read(ref, name)
        for damaged in (None, content[:-1], bytes([content[0] ^ 1]) + content[1:]):
            place.write(ref, name, damaged)
            with pytest.raises((CorruptArtifactError, MissingArtifactError)):
                store.export_artifact(ref)
        place.write(ref, name, content)
    with pytest.raises(MissingArtifactError):
        store.export_artifact(ABSENT)


def test_a_changed_or_misplaced_file_is_not_imported(store, ref):
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
