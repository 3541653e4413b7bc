"""Pictures of a video: runs of frames that show the same, and for each frame the next and previous one that differs."""

from bisect import bisect_right
from collections.abc import Collection, Sequence

from moseg.schemas.recipes import Ref
from moseg.workflows.graph.sections import Section


class Pictures:
    """Pictures of a video in their order, each of which is shown by one frame or repeated by those that follow it.

    Frames in a row with the same reference show one picture. If all frames do, each counts as a picture of its own:
    there is no other one to compare it with.

    Parameters
    ----------
    frames : sequence of references
    repetitions : collection of int
        Further frames that repeat the frame before them, although they were not decoded to the same.
    gaps : sequence of int, optional
        For each frame, how many pictures farther the one is that it is compared with; by default the next one.

    Attributes
    ----------
    num_followed : int
        Number of frames, from the first, that are compared with a picture after them.
    """

    def __init__(self, frames: Sequence[Ref], repetitions: Collection[int] = (), gaps: Sequence[int] = ()):
        repeated = set(repetitions)
        starts = [
            frame
            for frame, ref in enumerate(frames)
            if not frame or (ref != frames[frame - 1] and frame not in repeated)
        ]
        self._starts = list(range(len(frames))) if len(starts) == 1 else starts
        self._num_frames = len(frames)
        self._gaps = gaps
        # Gaps may differ, but frames that lack a side are those at the ends: none between counts as having it.
        frame_numbers = range(self._num_frames)
        self._first_with_previous = 1 + max(
            (frame for frame in frame_numbers if self._before(frame) is None), default=-1
        )
        self.num_followed = min(
            (frame for frame in frame_numbers if self._after(frame) is None), default=self._num_frames
        )

    def __len__(self) -> int:
        """Return the number of pictures."""
        return len(self._starts)

    def of(self, frame: int) -> int:
        """Return the picture that a frame shows."""
        return bisect_right(self._starts, frame) - 1

    def frames(self, picture: int) -> range:
        """Return the frames that show a picture."""
        following = picture + 1
        return range(self._starts[picture], self._starts[following] if following < len(self) else self._num_frames)

    def distinct(self, start: int, stop: int) -> list[int]:
        """Return one frame for every picture that the frames start..stop show, the first of those that show it."""
        return [frame for frame in range(start, stop) if frame == start or not self.repeats_previous(frame)]

    def gap(self, frame: int) -> int:
        """Return how many pictures farther the one is that a frame is compared with."""
        return self._gaps[frame] if self._gaps else 1

    def gap_of(self, section: Section) -> int:
        """Return the same of a section: that of the frame in its middle."""
        return self.gap((section.start + section.stop) // 2)

    def previous(self, frame: int) -> int | None:
        """Return the nearest frame before one that shows the picture it is compared with; None if there is none."""
        return self._before(frame) if frame >= self._first_with_previous else None

    def _before(self, frame: int) -> int | None:
        picture = self.of(frame) - self.gap(frame)
        return self.frames(picture).stop - 1 if picture >= 0 else None

    def next(self, frame: int) -> int | None:
        """Return the nearest frame after one that shows the picture it is compared with; None if there is none."""
        return self._after(frame) if frame < self.num_followed else None

    def _after(self, frame: int) -> int | None:
        picture = self.of(frame) + self.gap(frame)
        return self._starts[picture] if picture < len(self) else None

    def repeats_previous(self, frame: int) -> bool:
        """Return whether the frame before shows the same picture."""
        return frame > self.frames(self.of(frame)).start

    def repeats_next(self, frame: int) -> bool:
        """Return whether the frame after shows the same picture."""
        return frame < self.frames(self.of(frame)).stop - 1

    def shares(self, frame: int) -> dict[str, float]:
        """Return the shares of a frame's motion that lie between it and the frames right beside it, by side."""
        share = 1 / self.gap(frame)
        return {
            "previous": 0.0 if self.repeats_previous(frame) else share,
            "next": 0.0 if self.repeats_next(frame) else share,
        }

    @property
    def followed(self) -> Sequence[int]:
        """Frames that are compared with a picture after them."""
        return range(self.num_followed)

    def ends_in(self, start: int, stop: int) -> dict[str, int]:
        """Return which of the frames start..stop lack a neighbour, as own_motion and moves_now take it.

        Counted from `start`, frames up to 0 have no previous one, and frames from `num_frames` - 1 on no next one.
        Both depend on what is missing, not on the place of the frames in the video.
        """
        own_start = max(min(start - self._first_with_previous + 1, 1), start - stop + 1)
        num_seen = max(min(self.num_followed + 1, stop + 1) - start, 1)
        return {"start": own_start, "num_frames": own_start + num_seen}
