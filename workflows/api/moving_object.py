"""One object of a video that moves on its own, and the evidence for it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from moseg.workflows.exports.motion_json import FrameFigures


@dataclass(frozen=True)
class MovingObject:
    """One object that moves on its own.

    Attributes
    ----------
    identity : int
        Value of its pixels in the labels, the same in every frame.
    motion : int
        Motion group: objects of one group move together.
    first_frame, last_frame : int
        Counted from 0, both with at least one pixel of the object.
    num_frames : int
        Frames with at least one pixel of it.
    mean_area_fraction : float
        Its share of the frame's pixels, 0..1, mean over those frames.
    tag : str or None
        What a network called it, where one did.
    name : str or None
        What a correction calls it, where one does.
    moving_frames : tuple of (int, int) or None
        First and last frame of each run of frames in which it moves now; in its other frames it rests. None if this
        is not known.
    sure, complete : float or None
        Expected precision of its masks (share that moves on its own) and recall (share of the object that they cover),
        0..1, means over its frames; None if this is not known. They are calibrated on scenes with ground truth.
    per_frame : FrameFigures or None
        Its frames, with its share of the frame's pixels and these figures in each, as columns.
    static_support : mapping of str to float
        How well the background's motion explains the object, 0..1, under each motion model that has one (``trajs``,
        ``oc_depth`` …): ``exp(-d² / 2)``, with d the error of the background's model on the object beyond that of the
        object's own model, in units of the tolerated error. ``rigid`` is 0 where no rigid scene explains the object; it
        is absent where the object was not compared with one, and where that left open whether it moves.
    score : float or None
        ``1 - min(static_support)``, 0..1: how clearly the object moves by the evidence that separates it best from
        the background. It is evidence, not a probability. With the default ``clustering.static`` an object is dropped
        as static where every model supports that, so a low score belongs to an object without a value under some
        model. None where no model has a value for the object, or none was used (variant ``base``).
    """

    identity: int
    motion: int
    first_frame: int
    last_frame: int
    num_frames: int
    mean_area_fraction: float
    tag: str | None = None
    name: str | None = None
    moving_frames: tuple[tuple[int, int], ...] | None = None
    sure: float | None = None
    complete: float | None = None
    per_frame: FrameFigures | None = None
    static_support: Mapping[str, float] = field(default_factory=dict)

    def moves_now(self, frame: int) -> bool | None:
        """Return whether the object moves in a frame, counted from 0; None if this is not known."""
        if self.moving_frames is None:
            return None
        return any(first <= frame <= last for first, last in self.moving_frames)

    @property
    def score(self) -> float | None:
        """See the class."""
        return 1.0 - min(self.static_support.values()) if self.static_support else None
