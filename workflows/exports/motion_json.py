"""``motion.json``: what moves in a video, when and how large."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from pydantic import Field

from schemas.errors import InputError
from schemas.frozen import Frozen
from workflows.exports.write_text import write_text


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
        What a network called it, where one did.
    """

    identity: int = Field(ge=1)
    motion: int = Field(ge=0)
    first_frame: int = Field(ge=0)
    last_frame: int = Field(ge=0)
    num_frames: int = Field(ge=1)
    mean_area_fraction: float = Field(gt=0, le=1)
    tag: str | None = None


class SequenceSummary(Frozen):
    """One sequence: its frames, and its moving objects by identity. ``num_motions`` counts the background's too."""

    name: str
    num_frames: int
    width: int
    height: int
    fps: float
    num_motions: int
    objects: tuple[ObjectSummary, ...]


def summarise_sequence(
    name: str,
    labels: Iterable[np.ndarray],
    fps: float,
    num_motions: int,
    motions: Mapping[int, int],
    tags: Mapping[int, str] | None = None,
) -> SequenceSummary:
    """Follow each identity through a sequence's masks, one frame in memory at a time.

    Parameters
    ----------
    labels : iterable of uint16 (y, x)
        0 = static.
    fps : float
        Frames per second.
    num_motions : int
        Motion groups of the sequence, the background's included.
    motions : mapping of int to int
        Motion group of each identity that occurs.
    tags : mapping of int to str, optional
        What the identities are called, where they have names.

    Raises
    ------
    InputError
        Where there is no frame.
    """
    visible: dict[int, list[int]] = {}
    areas: dict[int, list[int]] = {}
    shape, num_frames = None, 0
    for index, frame in enumerate(labels):
        shape, num_frames = frame.shape, index + 1
        counts = np.bincount(frame.ravel())
        for identity in np.flatnonzero(counts[1:]) + 1:
            visible.setdefault(int(identity), []).append(index)
            areas.setdefault(int(identity), []).append(int(counts[identity]))
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
        )
        for identity in sorted(visible)
    )
    return SequenceSummary(
        name=name, num_frames=num_frames, width=width, height=height, fps=fps, num_motions=num_motions, objects=objects
    )


def write_motion(path: Path, summary: SequenceSummary) -> None:
    """Write the summary as indented JSON; raises InputError where the file cannot be written."""
    write_text(path, summary.model_dump_json(indent=2) + "\n")
