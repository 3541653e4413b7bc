"""Timelines of objects as a page draws them: the outline of the area, runs of frames, and sentences on changes."""

from typing import NamedTuple

from moseg.workflows.reports.content import ObjectTimeline, SequencePanel, Thumbnail
from moseg.workflows.reports.page.viewer import data_url
from moseg.workflows.results.mask_history import ChangeKind, MaskChange

HEIGHT = 30
MAX_CHANGES = 12
"""Changes of one object that are listed; a mask that flickers has hundreds."""


class Jump(NamedTuple):
    """A frame to go to, and what is seen there: a sentence, or a picture with its alternative text."""

    frame: int
    text: str
    picture: str | None = None
    kind: str = ""


class Track(NamedTuple):
    """One object's row, in a drawing of `num_frames` x `height`.

    Attributes
    ----------
    outline : str
        Corners of the area over time, for an SVG polygon; as high as the drawing where the area is largest.
    moving : tuple of (float, float)
        Start and length of each run of frames in which it moves; empty where that is not known.
    thumbnails : tuple of Jump or None
    changes : tuple of Jump
    num_more : int
        Changes that are not listed.
    """

    timeline: ObjectTimeline
    outline: str
    moving: tuple[tuple[int, int], ...]
    thumbnails: tuple[Jump | None, ...]
    changes: tuple[Jump, ...]
    num_more: int
    max_percent: float
    height: int = HEIGHT


def lay_out_timelines(panel: SequencePanel) -> tuple[Track, ...]:
    """Return the rows of a sequence's timelines."""
    return tuple(_lay_out(timeline, panel.num_frames) for timeline in panel.timelines)


def describe_change(change: MaskChange) -> str:
    """Return a change in words."""
    if change.kind is ChangeKind.SHRINKS:
        text = f"shrinks to {change.amount} %"
    elif change.kind is ChangeKind.SPLITS:
        text = f"splits into {change.amount} parts"
    elif change.amount:
        text = f"gone for {change.amount} frame{'' if change.amount == 1 else 's'}"
    else:
        text = "not seen again"
    return f"{text}, at the edge" if change.is_at_edge else text


def _lay_out(timeline: ObjectTimeline, num_frames: int) -> Track:
    largest = max(timeline.areas, default=0.0) or 1.0
    corners = [(0, HEIGHT)]
    for place, area in enumerate(timeline.areas):
        level = round(HEIGHT * (1 - area / largest), 1)
        start, end = place * timeline.step, min((place + 1) * timeline.step, num_frames)
        corners += [(start, level), (end, level)]
    corners.append((num_frames, HEIGHT))
    changes = timeline.changes[:MAX_CHANGES]
    return Track(
        timeline=timeline,
        outline=" ".join(f"{x},{y:g}" for x, y in corners),
        moving=tuple((first, last - first + 1) for first, last in timeline.moving_frames or ()),
        thumbnails=tuple(each and _jump_to(each, timeline.name) for each in timeline.thumbnails),
        changes=tuple(Jump(each.frame, describe_change(each), kind=each.kind.value) for each in changes),
        num_more=len(timeline.changes) - len(changes),
        max_percent=largest,
    )


def _jump_to(thumbnail: Thumbnail, name: str) -> Jump:
    return Jump(thumbnail.frame, f"object {name} in frame {thumbnail.frame}", data_url(thumbnail.picture))
