"""Comparison of every byte of stored artifacts with their manifests."""

from collections.abc import Iterable, Iterator

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.store.backend import Backend
from moseg.store.codec import array_files
from moseg.store.names import check_ref
from moseg.store.outcomes import VerifyResult
from moseg.store.reading import decode_checked, read_all, read_sealed
from moseg.store.sealing import Sealed


def verify(backend: Backend, refs: Iterable[str] | None = None) -> Iterator[VerifyResult]:
    """See `ArtifactStore.verify`."""
    for ref in backend.refs() if refs is None else refs:
        try:
            check_artifact(backend, ref)
        except CorruptArtifactError as error:
            yield VerifyResult(ref, str(error))
        except MissingArtifactError:
            if refs is not None:
                raise
        else:
            yield VerifyResult(ref, None)


def check_artifact(backend: Backend, ref: str) -> Sealed:
    """Check one artifact's manifest, its list of files, its metadata and the digest of each array's decoded bytes.

    Raises
    ------
    CorruptArtifactError
        Any of these differs from what was committed.
    """
    sealed = check_list(backend, ref)
    files = read_all(backend, ref, sealed)
    for entry in sealed.manifest.arrays:
        try:
            needed = {path: files[path] for path in array_files(entry)}
        except KeyError as error:
            raise CorruptArtifactError("lost file", where=f"{ref} {error.args[0]}", ref=ref) from None
        decode_checked(ref, entry, needed)
    return sealed


def check_list(backend: Backend, ref: str) -> Sealed:
    """Check one artifact's manifest, and that exactly the files it names are there."""
    sealed = read_sealed(backend, check_ref(ref))
    if sealed.manifest.recipe.ref != ref:
        found = sealed.manifest.recipe.ref
        raise CorruptArtifactError("the recipe is another artifact's", where=ref, got=found, ref=ref)
    sizes = backend.file_sizes(ref, sealed.payload)
    listed = sealed.stored_sizes()
    for path in sorted(sizes.keys() | listed.keys()):
        if sizes.get(path) != listed.get(path):
            got = f"{sizes[path]} bytes" if path in sizes else "no file"
            expected = f"{listed[path]} bytes" if path in listed else "no file"
            raise CorruptArtifactError("wrong file", where=f"{ref} {path}", got=got, expected=expected, ref=ref)
    return sealed
