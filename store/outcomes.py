"""Return values of the store: outcomes of a put, of a verification and of a collection, and the pins of runs."""

from enum import StrEnum
from typing import NamedTuple

from moseg.schemas.frozen import Frozen
from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import Ref


class PutOutcome(StrEnum):
    """Outcome of a put. Both are success: the artifact is stored."""

    COMMITTED = "committed"
    LOST_RACE = "lost-race"
    """The artifact was stored already; the first one stays."""


class StoredArtifact(NamedTuple):
    """An artifact outside of a store: what `export_artifact` returns and `import_artifact` stores.

    Attributes
    ----------
    manifest : Manifest
        As it was committed: when, where, with which versions and in how many seconds it was computed.
    metadata : dict of str
        Digest of each of Zarr's metadata files, by relative path.
    files : dict of bytes
        Content of every file but the manifest, by relative path.
    """

    manifest: Manifest
    metadata: dict[str, str]
    files: dict[str, bytes]


class VerifyResult(NamedTuple):
    """One artifact and its damage; ``problem`` is None if it is intact."""

    ref: str
    problem: str | None

    @property
    def is_intact(self) -> bool:
        """Return whether every byte is the one that was committed."""
        return self.problem is None


class TaskUsage(NamedTuple):
    """Number of artifacts of one task and the bytes of their files."""

    num_artifacts: int
    nbytes: int


class Pin(Frozen):
    """References that a run needs, so that ``gc`` keeps them.

    Attributes
    ----------
    run : str
        Name of the run, if the pin has another name; empty otherwise.
    with_inputs : bool
        Whether everything that they were computed from is kept too.
    expires : float or None
        Seconds since the epoch at which a live run's lease ends; None for a pin that lasts until ``unpin``.
    space, pid : str, int
        Process that wrote the pin and the space (host and container) in which its number is valid.
    """

    run_id: str
    refs: tuple[Ref, ...]
    created: float
    expires: float | None
    space: str
    pid: int
    run: str = ""
    with_inputs: bool = True


class GcReport(NamedTuple):
    """Result of a collection: what it removed, or would remove if ``is_dry``.

    Attributes
    ----------
    num_kept : int
        Artifacts that stay: reached from a pin, or younger than the grace period.
    removed : tuple of str
        References of collected artifacts.
    leftovers : tuple of str
        Places of interrupted puts, ended pins, partial records and old quarantined artifacts, relative to the store's
        root.
    nbytes : int
        Bytes freed by both.
    is_dry : bool
        Whether nothing was deleted.
    left : int or None
        Bytes of the artifacts that stay, if a size was asked for.
    """

    num_kept: int
    removed: tuple[str, ...]
    leftovers: tuple[str, ...]
    nbytes: int
    is_dry: bool
    left: int | None = None
