"""The source of object proposals chosen for a stretch of video, with the figures of the choice."""

from typing import Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen


class StretchChoice(Frozen):
    """Choice of one stretch.

    Attributes
    ----------
    first_frame, last_frame : int
        Counted from 0.
    proposals : 'saliency' or 'tracks'
    reason : str
        Why, in words.
    moving : float
        Share of the stretch's frame pairs over which the camera moves; the other figures are of these pairs.
    gain : float
        Median share of the tracked corners that a rigid scene explains and no single plane does.
    inside : float
        Share of the pairs in which the point that the camera moves to, or away from, lies inside the frame.
    wander_deg : float
        Median angle between the camera's headings and their middle, degrees.
    shows_depth : bool
        Whether parallax suffices to compare each object with a rigid scene.
    """

    first_frame: int = Field(ge=0)
    last_frame: int = Field(ge=0)
    proposals: Literal["saliency", "tracks"]
    reason: str
    moving: float
    gain: float
    inside: float
    wander_deg: float
    shows_depth: bool

    def moved(self, num_frames: int) -> "StretchChoice":
        """Return the choice of a stretch that begins so many frames later."""
        frames = {"first_frame": self.first_frame + num_frames, "last_frame": self.last_frame + num_frames}
        return self.model_copy(update=frames)

    def __str__(self) -> str:
        figures = f"gain {self.gain:.2f}, epipole inside {self.inside:.2f}, heading wanders {self.wander_deg:.1f} deg"
        told = f"{self.reason}; {figures}" if self.moving else self.reason
        return f"{self.proposals} for frames {self.first_frame} to {self.last_frame} ({told})"
