"""Export of an artifact from one store and import into another: the same bytes, checked at both ends."""

from collections.abc import Mapping

from moseg.schemas.errors import CorruptArtifactError
from moseg.schemas.manifests import Manifest
from moseg.store.backend import Backend
from moseg.store.codec import METADATA, array_files
from moseg.store.outcomes import PutOutcome, StoredArtifact
from moseg.store.packing import PACK, is_packable, pack
from moseg.store.reading import decode_checked, read_all
from moseg.store.sealing import digest_metadata, seal
from moseg.store.verification import check_list


def export_artifact(backend: Backend, ref: str) -> StoredArtifact:
    """See `ArtifactStore.export_artifact`."""
    sealed = check_list(backend, ref)
    manifest = sealed.manifest
    files = read_all(backend, ref, sealed)
    artifact = StoredArtifact(manifest, sealed.metadata, files)
    check_copy(artifact)
    return artifact


def import_artifact(backend: Backend, artifact: StoredArtifact) -> PutOutcome:
    """See `ArtifactStore.import_artifact`; the manifest is sealed again for this backend."""
    ref = artifact.manifest.recipe.ref
    if backend.has(ref):
        return PutOutcome.LOST_RACE
    check_copy(artifact)
    return commit_packed(backend, artifact.manifest, artifact.metadata, artifact.files)


def commit_packed(
    backend: Backend, manifest: Manifest, metadata: Mapping[str, str], files: Mapping[str, bytes | memoryview]
) -> PutOutcome:
    """Write an artifact's files as one pack, unless they are too many or too large for it, and then its manifest."""
    files = {file.path: files[file.path] for file in manifest.files}
    is_packed = is_packable(files)
    stored = {PACK: pack(files)} if is_packed else files
    return backend.commit(manifest.recipe.ref, stored, lambda payload: seal(manifest, metadata, payload, is_packed))


def check_copy(artifact: StoredArtifact) -> None:
    """Check an artifact outside of a store; raises CorruptArtifactError if a byte or a name differs from its manifest.

    The names of files must be those that follow from the arrays: an artifact from an untrusted store cannot write a
    file anywhere else.
    """
    manifest, files = artifact.manifest, artifact.files
    ref = manifest.recipe.ref
    if manifest.key != manifest.recipe.key:
        raise CorruptArtifactError("the recipe is another artifact's", where=ref, got=manifest.key, ref=ref)
    sizes = {path: len(content) for path, content in files.items()}
    listed = {file.path: file.nbytes for file in manifest.files}
    if sizes != listed or sizes.keys() != _names(manifest):
        found = sorted(sizes.items() ^ listed.items()) or sorted(sizes.keys() ^ _names(manifest))
        raise CorruptArtifactError("wrong files", where=ref, got=found, ref=ref)
    digests = {path: digest_metadata(files[path]) for path in files if path.rpartition("/")[2] == METADATA}
    if digests != artifact.metadata:
        raise CorruptArtifactError("changed metadata", where=ref, ref=ref)
    for entry in manifest.arrays:
        decode_checked(ref, entry, {path: files[path] for path in array_files(entry)})


def _names(manifest: Manifest) -> set[str]:
    """Return the names of the files of a group with the manifest's arrays; none of an array with an invalid name."""
    arrays = [entry for entry in manifest.arrays if entry.name.isidentifier()]
    return {METADATA} | {path for entry in arrays for path in array_files(entry)}
