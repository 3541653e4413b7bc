"""Doubts about a result, each worth a look: objects that shrink at once, rest, or are doubtful or incomplete."""

from collections.abc import Container, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import SALIENCY_SOURCES, PipelineConfig
from moseg.schemas.presets import QUALITIES
from moseg.schemas.stretch_choice import StretchChoice
from moseg.workflows.exports.followed_object import FollowedObject

MOST = 3
"""Doubts that are told; the figures of all objects are in the summary."""
MIN_FRAMES = 5
"""Frames in a row below which a doubt is not told."""
SHRUNK = 0.55
"""Share of its largest area shortly before below which an object has shrunk."""
INCOMPLETE = 0.7
"""Expected recall below which a mask is incomplete."""
DOUBTFUL = 0.7
"""Expected precision below which a mask is doubtful."""


class Advice(NamedTuple):
    """Advice for a mask that is too small and for one that is too large; by default, what helps any mask."""

    too_small: str = "paint what is missing"
    too_large: str = "erase what does not belong to it"


BY_HAND = Advice()


def advise(config: PipelineConfig, choices: Iterable[StretchChoice] = ()) -> Advice:
    """Return advice that is not in force yet and would change something.

    Parameters
    ----------
    config : PipelineConfig
        Of the run.
    choices : iterable of StretchChoice
        Source of the proposals of each stretch, where it was chosen.
    """
    advice = BY_HAND
    if _gains_by_best(config):
        advice = advice._replace(too_small="try --quality best")
    is_compared = any(choice.shows_depth or choice.proposals == "tracks" for choice in choices)
    if is_compared or config.proposal_source in ("tracks", "motion-prompts"):
        advice = advice._replace(too_large=f"try --sensitivity {config.track_objects.sensitivity / 2:g}")
    return advice


def _gains_by_best(config: PipelineConfig) -> bool:
    """Return whether ``--quality best`` changes a parameter that this configuration reads."""
    read = {"flow": config.flow.method == "dis"}
    read |= dict.fromkeys(("saliency", "motion_network"), config.proposal_source in SALIENCY_SOURCES)
    return any(
        getattr(getattr(config, stage), name) != value
        for stage, chosen in QUALITIES["best"].items()
        if read.get(stage, True)
        for name, value in chosen.items()
    )


def find_doubts(
    objects: Sequence[FollowedObject],
    size: int,
    num_frames: int,
    has_moves: bool,
    has_confidence: bool,
    drawn: Container[int] = (),
    names: Mapping[int, str] = MappingProxyType({}),
    advice: Advice = BY_HAND,
) -> tuple[str, ...]:
    """Return what is worth a look, each in one line with what may help, the largest objects first.

    Parameters
    ----------
    objects : sequence of FollowedObject
    size : int
        Pixels of a frame.
    num_frames : int
    has_moves, has_confidence : bool
        Whether it is known in all frames when objects move, and how sure and complete they are.
    drawn : container of int
        Identities of which the user drew a part: no option changes that, but more of the brush does.
    names : mapping of int to str
        Names that the user gave the identities.
    advice : Advice
        What may help where the user drew nothing.
    """
    doubts = []
    for each in sorted(objects, key=lambda each: -sum(each.areas)):
        larger, smaller = BY_HAND if each.identity in drawn else advice
        doubt = _shrinks(each, size, num_frames, has_moves, larger)
        if doubt is None and has_confidence:
            doubt = _is_incomplete(each, larger) or _is_doubtful(each, smaller)
        if doubt is None and has_moves:
            doubt = _rests(each)
        if doubt is not None:
            name = f" ({names[each.identity]})" if each.identity in names else ""
            doubts.append(f"object {each.identity}{name} {doubt}")
    more = len(doubts) - MOST
    return (*doubts[:MOST], *([f"{more} more objects; see per_frame in motion.json"] if more > 0 else []))


def _shrinks(each: FollowedObject, size: int, num_frames: int, has_moves: bool, advice: str) -> str | None:
    """Return the doubt about an object that loses much of its area within a second, inside the frame.

    What goes away becomes smaller as its flow says, and loses nothing.
    """
    from moseg.tasks.confidence import kept_area

    areas, inside = np.zeros(num_frames, np.int64), np.zeros(num_frames, bool)
    areas[each.frames], inside[each.frames] = each.areas, ~np.array(each.at_border)
    growth = np.zeros(num_frames)
    growth[each.frames] = each.growth
    kept = kept_area(areas, growth)
    run = _first_run(np.flatnonzero(inside & (kept < SHRUNK)))
    if run is None:
        return None
    first, last = run
    before = areas[first] / kept_area(areas)[first] / size
    what = "it may have stopped" if has_moves and first not in each.moving else "a part of it may have stopped"
    told = f"{100 * before:.2g} to {100 * areas[first] / size:.2g} % of the frame"
    return f"loses half its area from frame {first} ({told}): {what}; look at frames {first} to {last}, {advice}"


def _is_incomplete(each: FollowedObject, advice: str) -> str | None:
    run = _first_run(_frames_below(each, each.complete, INCOMPLETE))
    if run is None:
        return None
    covered = _mean(each, each.complete, run)
    where = f"in frames {run[0]} to {run[1]}"
    return f"is probably incomplete {where}: about {covered} % of it is covered; {advice}"


def _is_doubtful(each: FollowedObject, advice: str) -> str | None:
    run = _first_run(_frames_below(each, each.sure, DOUBTFUL))
    if run is None:
        return None
    moves = f"about {_mean(each, each.sure, run)} % of its mask moves"
    return f"is doubtful in frames {run[0]} to {run[1]}: {moves}; {advice}"


def _rests(each: FollowedObject) -> str | None:
    run = _first_run(sorted({*each.frames} - {*each.moving}))
    if run is None:
        return None
    return f"stops: it rests in frames {run[0]} to {run[1]}"


def _frames_below(each: FollowedObject, values: Sequence[float | None], limit: float) -> list[int]:
    return [frame for frame, value in zip(each.frames, values, strict=True) if value is not None and value < limit]


def _mean(each: FollowedObject, values: Sequence[float | None], run: tuple[int, int]) -> int:
    """Return the mean of the values in a run of frames, per cent."""
    known = [value for frame, value in zip(each.frames, values, strict=True) if run[0] <= frame <= run[1]]
    return round(100 * float(np.mean([value for value in known if value is not None])))


def _first_run(frames: Iterable[int]) -> tuple[int, int] | None:
    """Return first and last of the first run of `MIN_FRAMES` or more consecutive numbers; None without one."""
    first = last = None
    for frame in frames:
        frame = int(frame)
        if last is not None and frame == last + 1:
            last = frame
            continue
        if last is not None and last - first + 1 >= MIN_FRAMES:
            break
        first = last = frame
    return (first, last) if last is not None and last - first + 1 >= MIN_FRAMES else None
