"""Fixtures: the kinds of stores on which every law of this folder is tested, and a toy artifact."""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar, NamedTuple

import numpy as np
import obstore
import pytest

from moseg.schemas.recipes import Recipe, split_ref
from moseg.store import ArtifactStore, LocalStore, PutOutcome, copying, open_store
from moseg.store.names import MANIFEST, slot
from moseg.store.packing import PACK, places
from moseg.store.remote.connection import connect
from moseg.store.remote.layout import manifest_name, payload_folder


class Toy(NamedTuple):
    """A recipe, and the arrays of its artifact."""

    recipe: Recipe
    masks: np.ndarray
    scores: np.ndarray
    dims: dict[str, tuple[str, ...]]

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        """Arrays by name."""
        return {"masks": self.masks, "scores": self.scores}


class Place(ABC):
    """The place of a store, which is opened there, and whose bytes are reached without it."""

    without_manifest: ClassVar[list[bool]] = [False]
    """Result of `verify` for an artifact that has lost its manifest."""

    @abstractmethod
    def open(self) -> ArtifactStore:
        """Return the store, the same one at each call."""

    @abstractmethod
    def files(self, ref: str) -> list[str]:
        """Return the names of the files of one artifact."""

    @abstractmethod
    def read(self, ref: str, name: str) -> bytes:
        """Return the content of a file."""

    @abstractmethod
    def write(self, ref: str, name: str, content: bytes | None) -> None:
        """Replace a file, or delete it if `content` is None."""

    def damage(self, store: ArtifactStore, ref: str, path: str, content: bytes | None) -> None:
        """Replace one of Zarr's files, or delete it if `content` is None: in a pack it has zeros then."""
        if PACK not in self.files(ref):
            self.write(ref, path, content)
            return
        start, nbytes = places(store.manifest(ref).files)[path]
        packed = self.read(ref, PACK)
        content = bytes(nbytes) if content is None else content
        self.write(ref, PACK, packed[:start] + content + packed[start + nbytes :])


class Folder(Place):
    """A folder of this machine."""

    def __init__(self, path: Path):
        self._path = path

    def open(self) -> ArtifactStore:
        return LocalStore(self._path)

    def files(self, ref: str) -> list[str]:
        folder = self._folder(ref)
        return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())

    def read(self, ref: str, name: str) -> bytes:
        return (self._folder(ref) / name).read_bytes()

    def write(self, ref: str, name: str, content: bytes | None) -> None:
        path = self._folder(ref) / name
        path.unlink(missing_ok=True)
        if content is not None:
            path.write_bytes(content)

    def _folder(self, ref: str) -> Path:
        task, key = split_ref(ref)
        return self._path / "objects" / task / key[:2] / key


class Bucket(Place):
    """A prefix on an S3 server; the bytes are reached by plain requests of the client."""

    without_manifest: ClassVar[list[bool]] = []

    def __init__(self, url: str):
        self._url = url
        self._payloads: dict[str, str] = {}

    def open(self) -> ArtifactStore:
        return open_store(self._url)

    def files(self, ref: str) -> list[str]:
        folder = self._payload(ref)
        names = [item["path"].removeprefix(f"{folder}/") for item in obstore.list(self._client(), folder).collect()]
        return [MANIFEST, *sorted(names)]

    def read(self, ref: str, name: str) -> bytes:
        return obstore.get(self._client(), self._name(ref, name)).bytes().to_bytes()

    def write(self, ref: str, name: str, content: bytes | None) -> None:
        if content is None:
            obstore.delete(self._client(), self._name(ref, name))
        else:
            obstore.put(self._client(), self._name(ref, name), content)

    def _client(self):
        return connect(self._url)

    def _name(self, ref: str, name: str) -> str:
        return manifest_name(ref) if name == MANIFEST else f"{self._payload(ref)}/{name}"

    def _payload(self, ref: str) -> str:
        # also while a test has deleted a file
        for item in obstore.list(self._client(), f"payloads/{slot(ref)}").collect():
            self._payloads[ref] = item["path"].split("/")[4]
        return payload_folder(ref, self._payloads[ref])


@pytest.fixture(params=["a folder", "separate files", "an object store"])
def place(request, tmp_path: Path, monkeypatch) -> Place:
    """Return the place of a new store of each kind.

    Artifacts are in separate files if they are too large for a pack, or of an earlier version.
    """
    if request.param == "an object store":
        return Bucket(request.getfixturevalue("s3"))
    if request.param == "separate files":
        monkeypatch.setattr(copying, "is_packable", lambda files: False)
    return Folder(tmp_path / "a store with blanks, ü and 動き")


@pytest.fixture
def store(place: Place) -> ArtifactStore:
    return place.open()


@pytest.fixture(scope="session")
def toy() -> Toy:
    """Return an artifact whose bytes are not all plain: a negative zero, a NaN and an infinity."""
    recipe = Recipe(task="toy", version=2, params={"gap": 3}, inputs={"frame": "frame/" + "0" * 64})
    masks = np.arange(4 * 5 * 6, dtype=np.uint16).reshape(4, 5, 6)
    scores = np.array([0.5, -0.0, np.nan, np.inf])
    return Toy(recipe, masks, scores, {"masks": ("frame", "y", "x"), "scores": ("object",)})


@pytest.fixture
def ref(store: ArtifactStore, toy: Toy) -> str:
    """Put the toy artifact and return its reference."""
    assert store.put(toy.recipe, toy.arrays, {"count": 7}, seconds=0.25, dims=toy.dims) is PutOutcome.COMMITTED
    return toy.recipe.ref
