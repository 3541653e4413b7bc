"""Summary of a sequence's moving objects from its masks, one frame in memory at a time."""

from collections.abc import Container, Iterable, Mapping
from itertools import repeat

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.stretch_choice import StretchChoice
from moseg.workflows.exports.doubts import BY_HAND, Advice, find_doubts
from moseg.workflows.exports.followed_object import FollowedObject, mean_known
from moseg.workflows.exports.motion_json import FrameFigures, ObjectSummary, SequenceSummary
from moseg.workflows.runlog.events import as_unicode


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
    confidences: Iterable[tuple[np.ndarray, np.ndarray] | None] | None = None,
    growths: Iterable[np.ndarray | None] | None = None,
    given_names: Mapping[int, str] | None = None,
    drawn: Container[int] = (),
    advice: Advice = BY_HAND,
    about_picture: tuple[str, ...] = (),
) -> SequenceSummary:
    """Follow each identity through a sequence's masks.

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
    confidences : iterable of two float64 (identity,) or None, optional
        Expected precision and recall of each identity's mask in each frame; None where they are not known.
    growths : iterable of float64 (identity,) or None, optional
        Logarithm of each identity's area over that in the frame before, by its flow, NaN if unknown; None where that is
        not known of any.
    given_names : mapping of int to str, optional
        Names that the user gave the identities.
    drawn : container of int, optional
        Identities of which the user drew a part, so that no option changes their masks.
    advice : Advice
        What may help where a mask is too small or too large.
    about_picture : tuple of str
        What is worth a look in the frames, whatever was found in them.

    Raises
    ------
    InputError
        Where there is no frame.
    """
    followed: dict[int, FollowedObject] = {}
    has_moves, has_confidence = moves is not None, confidences is not None
    shape, num_frames = None, 0
    # Without them there is None for every frame.
    known = (repeat(None) if each is None else each for each in (moves, confidences, growths))
    for index, (frame, moves_now, confidence, growth) in enumerate(zip(labels, *known, strict=False)):
        shape, num_frames = frame.shape, index + 1
        counts = np.bincount(frame.ravel())
        at_border = {*np.unique(np.concatenate([frame[0], frame[-1], frame[:, 0], frame[:, -1]])).tolist()}
        for identity in (np.flatnonzero(counts[1:]) + 1).tolist():
            each = followed.setdefault(identity, FollowedObject(identity))
            grown = 0.0 if growth is None else float(np.nan_to_num(growth[identity]))
            each.see(index, int(counts[identity]), identity in at_border, grown)
            if moves_now is not None and moves_now[identity] == 1:
                each.moving.append(index)
            if confidence is not None:
                each.judge(*(float(values[identity]) for values in confidence))
        has_moves = has_moves and (moves_now is not None or not followed)
        has_confidence = has_confidence and (confidence is not None or not followed)
    if shape is None:
        raise InputError("no frame to summarise", where=name, got=0, expected="at least 1")
    size = shape[0] * shape[1]
    seen = [followed[identity] for identity in sorted(followed)]
    doubts = find_doubts(seen, size, num_frames, has_moves, has_confidence, drawn, given_names or {}, advice)
    return SequenceSummary(
        name=as_unicode(name),
        num_frames=num_frames,
        width=shape[1],
        height=shape[0],
        fps=fps,
        num_motions=num_motions,
        objects=tuple(
            _summarise(each, motions[each.identity], size, has_moves, has_confidence).model_copy(
                update={"tag": (tags or {}).get(each.identity), "name": (given_names or {}).get(each.identity)}
            )
            for each in seen
        ),
        frames=frames,
        choices=choices,
        look_at=(*about_picture, *doubts),
    )


def _summarise(each: FollowedObject, motion: int, size: int, has_moves: bool, has_confidence: bool) -> ObjectSummary:
    """Return the summary of an object in frames of `size` pixels, without its names."""
    figures = FrameFigures(
        frame=tuple(each.frames),
        area_fraction=tuple(float(f"{area / size:.4g}") for area in each.areas),
        sure=tuple(each.sure) if has_confidence else None,
        complete=tuple(each.complete) if has_confidence else None,
    )
    return ObjectSummary(
        identity=each.identity,
        motion=motion,
        first_frame=each.frames[0],
        last_frame=each.frames[-1],
        num_frames=len(each.frames),
        mean_area_fraction=float(np.mean(each.areas)) / size,
        moving_frames=runs_of(each.moving) if has_moves else None,
        sure=mean_known(each.sure) if has_confidence else None,
        complete=mean_known(each.complete) if has_confidence else None,
        per_frame=figures,
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
