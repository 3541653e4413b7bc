"""Labels of a section's frames from its objects, from what was painted on them, and from tables of identities."""

from typing import NamedTuple

import numpy as np

from moseg.tasks.corrections.replay import CorrectedObjects, Members, Runs

UNTOUCHED = -1
"""Painted label of a pixel that no stroke reaches."""


class LabelTables(NamedTuple):
    """Tables that decide the label of each pixel of a sequence.

    Attributes
    ----------
    labels : int32 (run, 3)
        Object, first frame, label from there on; 0 = not shown.
    stroke_labels : int32 (run, 3)
        The same of each number of strokes.
    members : int32 (member, 4)
        Number of strokes that erase, object that they erase, first frame, frame after the last.
    stroke_members : int32 (member, 4)
        The same of numbers of strokes that they erase.
    """

    labels: np.ndarray
    stroke_labels: np.ndarray
    members: np.ndarray
    stroke_members: np.ndarray


def label_tables(corrected: CorrectedObjects) -> LabelTables:
    """Return what decides the label of each pixel."""
    return LabelTables(
        label_table(corrected.runs, corrected.shown),
        label_table(corrected.stroke_runs, corrected.shown),
        _member_table(corrected.members),
        _member_table(corrected.stroke_members),
    )


def label_table(runs: dict[int, Runs], shown: frozenset[int]) -> np.ndarray:
    """Return runs as a table, int32 (run, 3): object or number of strokes, first frame, label; 0 = not shown."""
    rows = [
        (key, first, identity if identity in shown else 0)
        for key, found in sorted(runs.items())
        for first, identity in found
    ]
    return np.array(rows, np.int32).reshape(-1, 3)


def _member_table(members: dict[int, Members]) -> np.ndarray:
    rows = [(number, *each) for number, found in sorted(members.items()) for each in found]
    return np.array(rows, np.int32).reshape(-1, 4)


def motion_array(corrected: CorrectedObjects) -> np.ndarray:
    """Return the motion group of each object, uint16 (identity,); 0 = the background's, and where there is none."""
    motion = np.zeros(max(corrected.motions, default=0) + 1, np.uint16)
    for identity, group in corrected.motions.items():
        motion[identity] = group
    return motion


def relabel_section(
    masks: np.ndarray,
    objects: np.ndarray,
    tables: LabelTables,
    start: int,
    painted: np.ndarray | None = None,
    erased: tuple[tuple[int, ...], ...] = (),
) -> np.ndarray:
    """Return the labels of a section's frames.

    Parameters
    ----------
    masks : uint16 (T, y, x)
        Objects of the section; 0 = background.
    objects : int (section object,)
        What `tables` call each object of the section; that of the background is not in them.
    tables : LabelTables
    start : int
        Frame of the sequence with which the section starts.
    painted : int32 (T, y, x), optional
        Number of the strokes on each pixel; 0 erased, `UNTOUCHED`, or below it ``UNTOUCHED - n`` where only the objects
        of the n-th entry of `erased` are erased, counted from 1.
    erased : tuple of tuple of int
        What is beneath, a number of strokes or `UNTOUCHED`, and then the numbers of the strokes that erase.

    Returns
    -------
    uint16 (T, y, x)
        0 static, else an identity.
    """
    labels = np.empty(masks.shape, np.uint16)
    # Of a long video, a section has few objects.
    table = tables.labels[np.isin(tables.labels[:, 0], objects)]
    # Frame by frame, because NumPy converts labels that index an array to integers of four times their size.
    for t, (mask, out) in enumerate(zip(masks, labels, strict=True)):
        label_of = labels_at(table, start + t)
        out[:] = np.array([label_of.get(int(each), 0) for each in objects], np.uint16)[mask]
        if painted is None or painted[t].max() == painted[t].min() == UNTOUCHED:
            continue
        label_of = {0: 0, **labels_at(tables.stroke_labels, start + t)}
        for value in np.unique(painted[t]).tolist():
            if value == UNTOUCHED:
                continue
            beneath, *erasing = (value,) if value > UNTOUCHED else erased[UNTOUCHED - 1 - value]
            under = painted[t] == value
            if beneath == UNTOUCHED:
                gone = np.isin(objects, members_at(tables.members, erasing, start + t))
                out[under & gone[mask]] = 0
            else:
                is_gone = beneath in members_at(tables.stroke_members, erasing, start + t)
                out[under] = 0 if is_gone else label_of[beneath]
    return labels


def labels_at(table: np.ndarray, frame: int) -> dict[int, int]:
    """Return the label of each object, or number of strokes, of a table in a frame."""
    # Rows of one object follow each other in time, so the last one that has begun remains.
    return {key: label for key, first, label in table.tolist() if first <= frame}


def members_at(table: np.ndarray, numbers: list[int], frame: int) -> list[int]:
    """Return the objects, or numbers of strokes, that strokes of any of some numbers erase in a frame."""
    number, key, first, stop = table.T
    return key[np.isin(number, numbers) & (first <= frame) & (frame < stop)].tolist()
