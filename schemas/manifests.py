"""Manifests: the content of an artifact, its recipe, and how it was computed."""

from pydantic import JsonValue

from moseg.schemas.frozen import Frozen
from moseg.schemas.recipes import Recipe


class ArrayEntry(Frozen):
    """One array: its name, numpy dtype string, shape, axis names and the digest of its decoded bytes."""

    name: str
    dtype: str
    shape: tuple[int, ...]
    dims: tuple[str, ...]
    digest: str


class FileEntry(Frozen):
    """One file of the artifact, relative to its folder, with its size in bytes."""

    path: str
    nbytes: int


class Manifest(Frozen):
    """The manifest of an artifact, written last into its folder: an artifact with a manifest is complete.

    Attributes
    ----------
    attributes : dict of JSON values
        Small results that are not arrays (scores, counts, reasons); part of the artifact's content.
    seconds : float
        Time spent inside the task's function.
    nbytes : int
        Bytes of all files except the manifest.
    created : str
        UTC time, ISO 8601.
    versions : dict
        Library name to version, of the process that computed the artifact.
    """

    format: int = 1
    key: str
    recipe: Recipe
    arrays: tuple[ArrayEntry, ...]
    attributes: dict[str, JsonValue] = {}
    files: tuple[FileEntry, ...] = ()
    seconds: float
    nbytes: int
    created: str
    host: str
    versions: dict[str, str]

    def array(self, name: str) -> ArrayEntry:
        """Return the entry of one array; raise KeyError if there is none of that name."""
        for entry in self.arrays:
            if entry.name == name:
                return entry
        raise KeyError(name)
