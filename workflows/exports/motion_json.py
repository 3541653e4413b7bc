"""``motion.json``: what moves in a video, when and how large."""

from collections.abc import Iterable, Mapping
from itertools import repeat
from pathlib import Path

import numpy as np
from pydantic import Field, ValidationError

from moseg.schemas.errors import InputError
from moseg.schemas.frozen import Frozen
from moseg.schemas.stretch_choice import StretchChoice
from moseg.workflows.exports.write_text import write_text
from moseg.workflows.runlog.events import as_unicode
from moseg.workflows.sources import FrameSource, ImageFiles
from moseg.workflows.sources.files import read_bytes


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
    moving_frames : tuple of (int, int) or None
        First and last frame of each run of frames in which it moves now; in its other frames it rests. None if this
        is not known: frames whose objects do not come from motion saliency are left open.
    """

    identity: int = Field(ge=1)
    motion: int = Field(ge=0)
    first_frame: int = Field(ge=0)
    last_frame: int = Field(ge=0)
    num_frames: int = Field(ge=1)
    mean_area_fraction: float = Field(gt=0, le=1)
    tag: str | None = None
    moving_frames: tuple[tuple[int, int], ...] | None = None

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


def summarise_sequence(
    name: str,
    labels: Iterable[np.ndarray],
    fps: float,
    num_motions: int,
    motions: Mapping[int, int],
    tags: Mapping[int, str] | None = None,
    frames: tuple[str, ...] | None = None,
    choices: tuple[StretchChoice, ...] = (),
    moves: Iterable[np.ndarray | None] | None = None,
) -> SequenceSummary:
    """Follow each identity through a sequence's masks, one frame in memory at a time.

    Parameters
    ----------
    name : str
        Bytes that are not UTF-8, as a folder's name may have, are escaped: JSON cannot hold them.
    labels : iterable of uint16 (y, x)
        0 = static.
    fps : float
        Frames per second.
    num_motions : int
        Motion groups of the sequence, the background's included.
    motions : mapping of int to int
        Motion group of each identity that occurs.
    tags : mapping of int to str, optional
        Names of the identities, where they have any.
    frames : tuple of str, optional
        File names of the frames, where they have any.
    choices : tuple of StretchChoice, optional
        Source of the proposals of each stretch, where it was chosen.
    moves : iterable of int8 (identity,) or None, optional
        Whether each identity moves in each frame: 1 moves, 0 rests, -1 unseen; None where that is not known.

    Raises
    ------
    InputError
        Where there is no frame.
    """
    visible: dict[int, list[int]] = {}
    areas: dict[int, list[int]] = {}
    moving: dict[int, list[int]] = {}
    is_known = moves is not None
    shape, num_frames = None, 0
    for index, (frame, moves_now) in enumerate(zip(labels, repeat(None) if moves is None else moves, strict=False)):
        shape, num_frames = frame.shape, index + 1
        counts = np.bincount(frame.ravel())
        for identity in np.flatnonzero(counts[1:]) + 1:
            visible.setdefault(int(identity), []).append(index)
            areas.setdefault(int(identity), []).append(int(counts[identity]))
            if moves_now is not None and moves_now[identity] == 1:
                moving.setdefault(int(identity), []).append(index)
        is_known = is_known and (moves_now is not None or not visible)
    if shape is None:
        raise InputError("no frame to summarise", where=name, got=0, expected="at least 1")
    height, width = shape
    objects = tuple(
        ObjectSummary(
            identity=identity,
            motion=motions[identity],
            first_frame=visible[identity][0],
            last_frame=visible[identity][-1],
            num_frames=len(visible[identity]),
            mean_area_fraction=float(np.mean(areas[identity])) / (height * width),
            tag=(tags or {}).get(identity),
            moving_frames=runs_of(moving.get(identity, [])) if is_known else None,
        )
        for identity in sorted(visible)
    )
    return SequenceSummary(
        name=as_unicode(name),
        num_frames=num_frames,
        width=width,
        height=height,
        fps=fps,
        num_motions=num_motions,
        objects=objects,
        frames=frames,
        choices=choices,
    )


def runs_of(frames: Iterable[int]) -> tuple[tuple[int, int], ...]:
    """Return first and last of each run of consecutive numbers, which ascend."""
    runs: list[tuple[int, int]] = []
    for frame in frames:
        if runs and frame == runs[-1][1] + 1:
            runs[-1] = (runs[-1][0], frame)
        else:
            runs.append((frame, frame))
    return tuple(runs)


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
