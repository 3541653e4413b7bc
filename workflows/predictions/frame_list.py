"""The frames that predictions are matched to."""

from typing import NamedTuple


class FrameList(NamedTuple):
    """Frames of a sequence, annotated or not.

    Attributes
    ----------
    num_frames : int
    stems : tuple of str or None
        Their names without suffix, one each; None where they have none.
    """

    num_frames: int
    stems: tuple[str, ...] | None = None

    def name(self, index: int) -> str:
        """What a message calls a frame: its name, or its number from 0."""
        return self.stems[index] if self.stems else str(index)
