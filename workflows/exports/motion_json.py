"""``motion.json``: what moves in a video, when and how large."""

from pathlib import Path

from pydantic import Field, ValidationError

from moseg.schemas.errors import InputError
from moseg.schemas.frozen import Frozen
from moseg.schemas.stretch_choice import StretchChoice
from moseg.workflows.exports.write_text import write_text
from moseg.workflows.sources import FrameSource, ImageFiles
from moseg.workflows.sources.files import read_bytes


class FrameFigures(Frozen):
    """Figures of one object in each frame that shows it, as columns of one length.

    Attributes
    ----------
    frame : tuple of int
        Counted from 0.
    area_fraction : tuple of float
        Share of the frame's pixels.
    sure, complete : tuple of float, or None
        Expected precision of its mask (share that moves on its own) and recall (share of the object that it covers),
        0..1; None if this is not known, and in a frame whose mask is smaller than a pixel of the working grid.
    """

    frame: tuple[int, ...]
    area_fraction: tuple[float, ...]
    sure: tuple[float | None, ...] | None = None
    complete: tuple[float | None, ...] | None = None


class ObjectSummary(Frozen):
    """One moving object.

    Attributes
    ----------
    identity : int
        Value of its pixels in the masks.
    motion : int
        Motion group; 0 is the background's.
    first_frame, last_frame : int
        Counted from 0, both with at least one pixel of the object.
    num_frames : int
        Frames with at least one pixel of it.
    mean_area_fraction : float
        Its share of the frame's pixels, mean over those frames.
    tag : str or None
        Name that a network gave it, where one did.
    name : str or None
        Name that the user gave it by a correction.
    moving_frames : tuple of (int, int) or None
        First and last frame of each run of frames in which it moves now; in its other frames it rests. None if this
        is not known: frames whose objects do not come from motion saliency are left open.
    sure, complete : float or None
        Means of the figures of the same name over its frames; None if they are not known, as `moving_frames`.
    per_frame : FrameFigures or None
        None in files of earlier versions.
    """

    identity: int = Field(ge=1)
    motion: int = Field(ge=0)
    first_frame: int = Field(ge=0)
    last_frame: int = Field(ge=0)
    num_frames: int = Field(ge=1)
    mean_area_fraction: float = Field(gt=0, le=1)
    tag: str | None = None
    name: str | None = None
    moving_frames: tuple[tuple[int, int], ...] | None = None
    sure: float | None = Field(None, ge=0, le=1)
    complete: float | None = Field(None, ge=0, le=1)
    per_frame: FrameFigures | None = None

    @property
    def called(self) -> str | None:
        """The name of the object: the user's, else that of a network; None without either."""
        return self.name or self.tag

    def moves_now(self, frame: int) -> bool | None:
        """Return whether the object moves in a frame, counted from 0; None if this is not known."""
        if self.moving_frames is None:
            return None
        return any(first <= frame <= last for first, last in self.moving_frames)


class SequenceSummary(Frozen):
    """One sequence: its frames, and its moving objects by identity.

    Attributes
    ----------
    name : str
    num_frames, width, height : int
        Width and height in px.
    fps : float
        Frames per second.
    num_motions : int
        Motion groups, the background's included.
    objects : tuple of ObjectSummary
    frames : tuple of str or None
        File names of the frames, one each, where they came from a folder; None for a video.
    choices : tuple of StretchChoice
        Where the proposals of each stretch come from, if that was left to the camera's motion, and why.
    video : str or None
        Digest by which the video, or the folder of frames, is known again; None for arrays.
    numbers : tuple of int or None
        Numbers of the frames in the video, counted from 0, one each; None if all were read, or if they have names.
    look_at : tuple of str
        What is worth a look, in words; see `find_doubts`.
    """

    name: str
    num_frames: int
    width: int
    height: int
    fps: float
    num_motions: int
    objects: tuple[ObjectSummary, ...]
    frames: tuple[str, ...] | None = None
    choices: tuple[StretchChoice, ...] = ()
    video: str | None = None
    numbers: tuple[int, ...] | None = None
    look_at: tuple[str, ...] = ()


def frame_names(frames: FrameSource) -> tuple[str, ...] | None:
    """Return the file names of frames that come from a folder, one each; None for a video.

    Raises
    ------
    InputError
        A name that is no UTF-8, which JSON cannot hold.
    """
    if not isinstance(frames, ImageFiles):
        return None
    names = tuple(Path(path).name for path in frames.paths)
    for name in names:
        check_file_name(name, "frame", Path(frames.paths[0]).parent)
    return names


def check_file_name(name: str, what: str, where: object) -> None:
    """Raise InputError where a name cannot be that of one file, or JSON cannot hold it."""
    if not name or name == ".." or "\0" in name or Path(name).name != name:
        raise InputError(f"not a name of a {what}", where=where, got=repr(name), expected="a name without a folder")
    if any("\ud800" <= character <= "\udfff" for character in name):
        raise InputError(f"not a name of a {what}", where=where, got=repr(name), expected="a name in UTF-8")


def read_motion(path: Path) -> SequenceSummary:
    """Read a file that `write_motion` wrote.

    Raises
    ------
    InputError
        There is no such file, or it does not hold a summary.
    """
    content = read_bytes(str(path))
    try:
        return SequenceSummary.model_validate_json(content)
    except ValidationError as error:
        first = error.errors()[0]
        at = ".".join(map(str, first["loc"]))
        raise InputError("not a summary of motions", where=path, got=f"{at}: {first['msg']}".lstrip(": ")) from error


def write_motion(path: Path, summary: SequenceSummary) -> None:
    """Write the summary as indented JSON; raises InputError where the file cannot be written."""
    write_text(path, summary.model_dump_json(indent=2) + "\n")
