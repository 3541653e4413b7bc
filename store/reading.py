"""Reading an artifact back, checking every byte that is used.

Zarr reads a missing chunk as zeros. So the backend reads the files, each must have the length that its manifest names,
and only then are they decoded, from memory, with checksums.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from moseg.schemas.digests import digest_array, hash_array
from moseg.schemas.errors import CorruptArtifactError, InputError, StoreError
from moseg.schemas.manifests import ArrayEntry, Manifest
from moseg.schemas.recipes import split_ref
from moseg.store.backend import Backend
from moseg.store.codec import array_files, decode_array
from moseg.store.packing import PACK, pack, pack_nbytes, places
from moseg.store.sealing import Sealed, digest_metadata, unseal

WHOLE_BYTES = 65_536
"""Packs up to this size are read and checked as a whole, which takes no longer than a part."""


def read_manifest(backend: Backend, ref: str) -> Manifest:
    """See `ArtifactStore.manifest`."""
    return read_sealed(backend, ref).manifest


def read_sealed(backend: Backend, ref: str) -> Sealed:
    """Return the manifest of an artifact and the digests of its metadata files.

    Raises
    ------
    MissingArtifactError
        Nothing is stored under `ref`.
    CorruptArtifactError
        The manifest is lost, changed, or another artifact's.
    """
    return check_seal(ref, backend.read_manifest(ref))


def check_seal(ref: str, data: bytes) -> Sealed:
    """Parse a manifest file; raises CorruptArtifactError if it is changed, another artifact's, or forged.

    A reference that is the digest of its recipe also excludes artifacts that name each other as inputs.
    """
    try:
        sealed = unseal(data)
    except ValueError as error:
        raise CorruptArtifactError(str(error), where=ref, ref=ref) from None
    if (sealed.manifest.recipe.task, sealed.manifest.key) != split_ref(ref):
        found = f"{sealed.manifest.recipe.task}/{sealed.manifest.key}"
        raise CorruptArtifactError("another artifact's manifest", where=ref, got=found, ref=ref)
    if sealed.manifest.recipe.ref != ref:
        raise CorruptArtifactError("a manifest of another recipe", where=ref, got=sealed.manifest.recipe.ref, ref=ref)
    return sealed


def read_array(backend: Backend, ref: str, name: str, check: bool = False) -> np.ndarray:
    """See `ArtifactStore.read`."""
    sealed = read_sealed(backend, ref)
    entry = _entry(sealed.manifest, ref, name)
    return load_checked(backend, ref, sealed, entry) if check else load_array(backend, ref, sealed, entry)


def read_rows(backend: Backend, ref: str, name: str, start: int, stop: int) -> np.ndarray:
    """See `ArtifactStore.read_rows`."""
    sealed = read_sealed(backend, ref)
    entry = _entry(sealed.manifest, ref, name)
    num_rows = entry.shape[0] if entry.shape else 0
    if not 0 <= start <= stop <= num_rows:
        raise InputError(
            "rows outside the array", where=f"{ref} {name}", got=f"{start}:{stop}", expected=f"0:{num_rows}"
        )
    return load_array(backend, ref, sealed, entry, slice(start, stop))


def load_array(backend: Backend, ref: str, sealed: Sealed, entry: ArrayEntry, rows: slice = slice(None)) -> np.ndarray:
    """Read, check and decode one of the arrays that a manifest names, or rows of it."""
    return _decode(ref, entry, read_files(backend, ref, sealed, array_files(entry, rows)), rows)


def load_checked(backend: Backend, ref: str, sealed: Sealed, entry: ArrayEntry) -> np.ndarray:
    """Read and decode a whole array, and compare the decoded bytes with the digest in the manifest."""
    return decode_checked(ref, entry, read_files(backend, ref, sealed, array_files(entry)))


def decode_checked(ref: str, entry: ArrayEntry, files: Mapping[str, bytes]) -> np.ndarray:
    """Decode an array from its files; raises CorruptArtifactError if that fails or the digest differs."""
    array = _decode(ref, entry, files)
    # Stores of earlier versions hold BLAKE2b-256.
    digest = hash_array(array) if entry.digest.startswith("sha256:") else digest_array("array", array)
    if digest != entry.digest:
        raise CorruptArtifactError("the array's digest differs", where=f"{ref} {entry.name}", ref=ref)
    return array


def read_files(backend: Backend, ref: str, sealed: Sealed, paths: Sequence[str]) -> dict[str, bytes]:
    """Return the content of files, after checking their lengths and the digests of metadata files."""
    if not sealed.is_packed:
        return _check_files(ref, sealed, backend.read_files(ref, sealed.payload, paths))
    where = places(sealed.manifest.files)
    lost = [path for path in paths if path not in where]
    if lost:
        raise CorruptArtifactError("lost file", where=f"{ref} {lost[0]}", ref=ref)
    nbytes = pack_nbytes(sealed.manifest.files)
    if nbytes <= WHOLE_BYTES:
        files = read_all(backend, ref, sealed)
        return {path: files[path] for path in paths}
    ranges = {path: where[path] for path in paths}
    return _check_files(ref, sealed, backend.read_ranges(ref, sealed.payload, PACK, nbytes, ranges))


def read_all(backend: Backend, ref: str, sealed: Sealed) -> dict[str, bytes]:
    """Return the content of all files of an artifact, after the same checks and a comparison of the bytes between them.

    Raises CorruptArtifactError if a byte of the pack that belongs to no file is not what it must be.
    """
    paths = [file.path for file in sealed.manifest.files]
    if not sealed.is_packed:
        return read_files(backend, ref, sealed, paths)
    content = backend.read_files(ref, sealed.payload, [PACK])[PACK]
    where = places(sealed.manifest.files)
    found = {path: content[where[path].start : where[path].start + where[path].nbytes] for path in paths}
    files = _check_files(ref, sealed, found)
    if pack(files) != content:
        raise CorruptArtifactError("changed pack", where=f"{ref} {PACK}", ref=ref)
    return files


def _check_files(ref: str, sealed: Sealed, files: dict[str, bytes]) -> dict[str, bytes]:
    sizes = {file.path: file.nbytes for file in sealed.manifest.files}
    for path, content in files.items():
        nbytes = sizes.get(path, len(content))
        if len(content) != nbytes:
            raise CorruptArtifactError(
                "file of another length", where=f"{ref} {path}", got=len(content), expected=nbytes, ref=ref
            )
        if path in sealed.metadata and digest_metadata(content) != sealed.metadata[path]:
            raise CorruptArtifactError("changed metadata", where=f"{ref} {path}", ref=ref)
    return files


def _decode(ref: str, entry: ArrayEntry, files: Mapping[str, bytes], rows: slice = slice(None)) -> np.ndarray:
    try:
        return decode_array(entry, files, rows)
    except MemoryError:
        raise
    except Exception as error:
        # Zarr, its codecs and Blosc each raise their own exceptions on bytes that they cannot decode
        raise CorruptArtifactError(f"undecodable array: {error}", where=f"{ref} {entry.name}", ref=ref) from error


def _entry(manifest: Manifest, ref: str, name: str) -> ArrayEntry:
    try:
        return manifest.array(name)
    except KeyError:
        names = ", ".join(entry.name for entry in manifest.arrays) or "no arrays"
        raise StoreError("no such array", where=ref, got=name, expected=names) from None
