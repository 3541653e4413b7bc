"""Prompt points beside the true objects of a frame."""

from typing import NamedTuple

import numpy as np

from moseg.tasks.instances.motion_prompts import MotionPrompts


class PromptedFrame(NamedTuple):
    """Prompts of the first frame of a section, and where their points lie.

    Attributes
    ----------
    frame : int
    image : uint8 (y, x, rgb)
    prompts : MotionPrompts
    objects : tuple of int
        True objects of the frame that move.
    owners : integer (n, k)
        True object in which each point lies, 0 = none.
    truth : unsigned integer (y, x) or None
        True objects at every pixel; None if they are known at points alone.
    """

    frame: int
    image: np.ndarray
    prompts: MotionPrompts
    objects: tuple[int, ...]
    owners: np.ndarray
    truth: np.ndarray | None = None


class Hits(NamedTuple):
    """Counts over the objects and prompts of some frames.

    Attributes
    ----------
    objects : int
        True objects, counted in each frame.
    hit : int
        Those with a prompt point inside.
    clean : int
        Those of which every prompt with a point inside has no point outside; at least one has a point inside.
    prompts : int
    mixed : int
        Prompts with points in an object and outside of it.
    stray : int
        Prompts without a point in an object.
    """

    objects: int
    hit: int
    clean: int
    prompts: int
    mixed: int
    stray: int


def owners_in_masks(points: np.ndarray, truth: np.ndarray, void: int | None) -> np.ndarray:
    """Return the true object at each point.

    Parameters
    ----------
    points : floating (n, k, 2)
        xy, px of the true masks.
    truth : unsigned integer (y, x)
        0 = static.
    void : int or None
        Label of pixels that are no object.
    """
    columns, rows = np.rint(points).astype(int).transpose(2, 0, 1)
    height, width = truth.shape
    owners = truth[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)].astype(int)
    return np.where(owners == void, 0, owners) if void is not None else owners


def owners_by_nearest(points: np.ndarray, known: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Return the label of the nearest labelled point of each point.

    Parameters
    ----------
    points : floating (n, k, 2)
    known : floating (N, 2)
        Labelled points, in the same pixels.
    labels : integer (N,)
        0 = static.
    """
    distance = np.linalg.norm(points[:, :, None] - known, axis=-1)
    return labels[distance.argmin(axis=-1)].astype(int)


def is_hit(frame: PromptedFrame, label: int) -> bool:
    """Return whether a prompt point lies inside an object."""
    return bool((frame.owners == label).any())


def is_clean(frame: PromptedFrame, label: int) -> bool:
    """Return whether prompts have points inside an object, and none of these prompts has one outside."""
    inside = frame.owners == label
    touches = inside.any(axis=1)
    return bool(touches.any() and inside[touches].all())


def count_hits(frames: list[PromptedFrame]) -> Hits:
    """Count objects and prompts over frames."""
    pairs = [(frame, label) for frame in frames for label in frame.objects]
    inside = [row > 0 for frame in frames for row in frame.owners]
    owners = [row for frame in frames for row in frame.owners]
    return Hits(
        objects=len(pairs),
        hit=sum(is_hit(*pair) for pair in pairs),
        clean=sum(is_clean(*pair) for pair in pairs),
        prompts=len(owners),
        mixed=sum(bool(row.any()) and len(set(own.tolist())) > 1 for row, own in zip(inside, owners, strict=True)),
        stray=sum(not row.any() for row in inside),
    )
