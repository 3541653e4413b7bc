"""Reading an artifact back, trusting no byte.

Zarr takes a chunk that is not there for zeros. So files are read here, each must have the length its manifest names,
and only then does Zarr decode them, from memory, with checksums.
"""

import errno
import os

import numpy as np

from schemas.digests import digest_array, hash_array
from schemas.errors import CorruptArtifactError, InputError, MissingArtifactError, StoreError
from schemas.manifests import ArrayEntry, Manifest
from schemas.recipes import split_ref
from store.codec import array_files, decode_array
from store.layout import MANIFEST, Layout
from store.sealing import Sealed, digest_metadata, unseal

_DAMAGED = (errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EIO)


def read_manifest(layout: Layout, ref: str) -> Manifest:
    """The manifest of an artifact, its seal checked."""
    return read_sealed(layout, ref).manifest


def read_sealed(layout: Layout, ref: str) -> Sealed:
    """The manifest of an artifact and the digests of its metadata files.

    Raises
    ------
    MissingArtifactError
        Nothing is stored under `ref`.
    CorruptArtifactError
        The manifest is lost, changed, or another artifact's.
    """
    folder = layout.folder(ref)
    data = read_file(folder, MANIFEST, ref)
    try:
        sealed = unseal(data)
    except ValueError as error:
        raise CorruptArtifactError(str(error), where=ref, ref=ref) from None
    if (sealed.manifest.recipe.task, sealed.manifest.key) != split_ref(ref):
        found = f"{sealed.manifest.recipe.task}/{sealed.manifest.key}"
        raise CorruptArtifactError("another artifact's manifest", where=ref, got=found, ref=ref)
    return sealed


def read_array(layout: Layout, ref: str, name: str, check: bool) -> np.ndarray:
    """One whole array, its digest compared where `check`."""
    sealed = read_sealed(layout, ref)
    entry = _entry(sealed.manifest, ref, name)
    return load_checked(layout, ref, sealed, entry) if check else load_array(layout, ref, sealed, entry)


def read_rows(layout: Layout, ref: str, name: str, start: int, stop: int) -> np.ndarray:
    """Rows ``start`` to ``stop`` (exclusive) of an array's leading axis; raises InputError outside of it."""
    sealed = read_sealed(layout, ref)
    entry = _entry(sealed.manifest, ref, name)
    num_rows = entry.shape[0] if entry.shape else 0
    if not 0 <= start <= stop <= num_rows:
        raise InputError(
            "rows outside the array", where=f"{ref} {name}", got=f"{start}:{stop}", expected=f"0:{num_rows}"
        )
    return load_array(layout, ref, sealed, entry, slice(start, stop))


def load_array(layout: Layout, ref: str, sealed: Sealed, entry: ArrayEntry, rows: slice = slice(None)) -> np.ndarray:
    """Read, check and decode one of the arrays that a manifest names, or rows of it."""
    folder = layout.folder(ref)
    sizes = {file.path: file.nbytes for file in sealed.manifest.files}
    files = {path: read_file(folder, path, ref, sizes.get(path)) for path in array_files(entry, rows)}
    for path, content in files.items():
        if path in sealed.metadata and digest_metadata(content) != sealed.metadata[path]:
            raise CorruptArtifactError("changed metadata", where=f"{ref} {path}", ref=ref)
    try:
        return decode_array(entry, files, rows)
    except MemoryError:
        raise
    except Exception as error:
        # Zarr, its codecs and Blosc each raise their own kinds on bytes that they cannot decode
        raise CorruptArtifactError(f"undecodable array: {error}", where=f"{ref} {entry.name}", ref=ref) from error


def load_checked(layout: Layout, ref: str, sealed: Sealed, entry: ArrayEntry) -> np.ndarray:
    """As `load_array`, the whole array, and its decoded bytes compared with the digest in the manifest."""
    array = load_array(layout, ref, sealed, entry)
    # Stores of earlier versions hold BLAKE2b-256.
    digest = hash_array(array) if entry.digest.startswith("sha256:") else digest_array("array", array)
    if digest != entry.digest:
        raise CorruptArtifactError("the array's digest is another", where=f"{ref} {entry.name}", ref=ref)
    return array


def read_file(folder: str, path: str, ref: str, nbytes: int | None = None) -> bytes:
    """Content of one of an artifact's files, which must have `nbytes` bytes."""
    try:
        with open(f"{folder}/{path}", "rb", buffering=0) as file:
            content = file.readall()
    except OSError as error:
        if error.errno not in _DAMAGED:
            raise StoreError(f"cannot read: {error.strerror}", where=f"{ref} {path}") from error
        if not os.path.lexists(folder):
            raise MissingArtifactError("no such artifact", where=ref) from None
        raise CorruptArtifactError(f"unreadable file: {error.strerror}", where=f"{ref} {path}", ref=ref) from None
    if nbytes is not None and len(content) != nbytes:
        raise CorruptArtifactError(
            "file of another length", where=f"{ref} {path}", got=len(content), expected=nbytes, ref=ref
        )
    return content


def _entry(manifest: Manifest, ref: str, name: str) -> ArrayEntry:
    try:
        return manifest.array(name)
    except KeyError:
        names = ", ".join(entry.name for entry in manifest.arrays) or "no arrays"
        raise StoreError("no such array", where=ref, got=name, expected=names) from None
