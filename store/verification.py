"""Comparing every byte of stored artifacts with what their manifests name."""

import os
from collections.abc import Iterable, Iterator

from schemas.errors import CorruptArtifactError, MissingArtifactError
from store.layout import MANIFEST, Layout
from store.outcomes import VerifyResult
from store.reading import load_checked, read_file, read_sealed
from store.sealing import Sealed, digest_metadata


def verify(layout: Layout, refs: Iterable[str] | None = None) -> Iterator[VerifyResult]:
    """Check artifacts, all by default; those that vanish meanwhile are passed over.

    Raises MissingArtifactError where one that was asked for is not stored.
    """
    for ref in layout.refs() if refs is None else refs:
        try:
            check_artifact(layout, ref)
        except CorruptArtifactError as error:
            yield VerifyResult(ref, str(error))
        except MissingArtifactError:
            if refs is not None:
                raise
        else:
            yield VerifyResult(ref, None)


def check_artifact(layout: Layout, ref: str) -> None:
    """Check one artifact's manifest, its list of files, its metadata and the digest of each array's decoded bytes.

    Raises
    ------
    CorruptArtifactError
        Any of these is not as committed.
    """
    sealed = read_sealed(layout, ref)
    manifest = sealed.manifest
    if manifest.recipe.ref != ref:
        raise CorruptArtifactError("the recipe is another artifact's", where=ref, got=manifest.recipe.ref, ref=ref)
    _check_files(layout.folder(ref), ref, sealed)
    for entry in manifest.arrays:
        load_checked(layout, ref, sealed, entry)


def _check_files(folder: str, ref: str, sealed: Sealed) -> None:
    try:
        found = dict(_walk(folder))
    except FileNotFoundError:
        raise MissingArtifactError("no such artifact", where=ref) from None
    found.pop(MANIFEST, None)
    listed = {file.path: file.nbytes for file in sealed.manifest.files}
    for path in sorted(found.keys() | listed.keys()):
        if found.get(path) != listed.get(path):
            got = f"{found[path]} bytes" if path in found else "no file"
            expected = f"{listed[path]} bytes" if path in listed else "no file"
            raise CorruptArtifactError("wrong file", where=f"{ref} {path}", got=got, expected=expected, ref=ref)
    for path, digest in sealed.metadata.items():
        if digest_metadata(read_file(folder, path, ref)) != digest:
            raise CorruptArtifactError("changed metadata", where=f"{ref} {path}", ref=ref)


def _walk(folder: str, prefix: str = "") -> Iterator[tuple[str, int]]:
    """Relative path and size of every file; -1 for what is neither a file nor a folder."""
    for entry in os.scandir(folder):
        if entry.is_dir(follow_symlinks=False):
            yield from _walk(entry.path, f"{prefix}{entry.name}/")
        else:
            is_file = entry.is_file(follow_symlinks=False)
            yield f"{prefix}{entry.name}", entry.stat().st_size if is_file else -1
