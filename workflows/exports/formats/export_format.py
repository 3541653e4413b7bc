"""Export format: a name, a description and functions that write it."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Protocol, runtime_checkable

from moseg.workflows.exports.saved_segmentation import SavedSegmentation


class ExportTarget(Protocol):
    """The file or folder that a format writes."""

    def check(self) -> object:
        """Raise InputError where it cannot be written, or would replace a file that moseg did not write."""


@runtime_checkable
class KnownTarget(Protocol):
    """A target that knows what an earlier export wrote there."""

    def earlier(self) -> Path | None:
        """Return the path of what an earlier export wrote; None if there is nothing."""


class ExportFormat(NamedTuple):
    """A way to write a segmentation for another program.

    Attributes
    ----------
    name : str
    description : str
        Files that it writes and programs that read them.
    write : callable
        Of the segmentation, the folder to write in, and the dilation of what moves in px (None: the format's own), to
        the path that it wrote.
    target : callable
        Of the folder to write in, the name of the sequence and the file names of its frames, to what will be written.
    is_dilated : bool
        Whether the dilation has a meaning.
    check_names : callable, optional
        Of the frames' file names; raises InputError where the format cannot hold them.
    last_identity : int, optional
        The largest identity that it can hold.
    needs_frames : bool
        Whether it has the frames themselves in it.
    check_encoder : callable, optional
        Raises InputError where the encoder that it needs is missing.
    """

    name: str
    description: str
    write: Callable[[SavedSegmentation, Path, int | None], Path]
    target: Callable[[Path, str, tuple[str, ...]], ExportTarget]
    is_dilated: bool = False
    check_names: Callable[[tuple[str, ...]], None] | None = None
    last_identity: int | None = None
    needs_frames: bool = False
    check_encoder: Callable[[], None] | None = None
