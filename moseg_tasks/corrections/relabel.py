"""Labels of a section's frames from its objects, from what was painted on them, and from tables of identities."""

import numpy as np

from moseg.tasks.corrections.replay import CorrectedObjects, Runs

UNTOUCHED = -1
"""Painted label of a pixel that no stroke reaches."""


def label_table(runs: dict[int, Runs], shown: frozenset[int]) -> np.ndarray:
    """Return runs as a table, int32 (run, 3): object or number of strokes, first frame, label; 0 = not shown."""
    rows = [
        (key, first, identity if identity in shown else 0)
        for key, found in sorted(runs.items())
        for first, identity in found
    ]
    return np.array(rows, np.int32).reshape(-1, 3)


def motion_array(corrected: CorrectedObjects) -> np.ndarray:
    """Return the motion group of each object, uint16 (identity,); 0 = the background's, and where there is none."""
    motion = np.zeros(max(corrected.motions, default=0) + 1, np.uint16)
    for identity, group in corrected.motions.items():
        motion[identity] = group
    return motion


def relabel_section(
    masks: np.ndarray,
    objects: np.ndarray,
    table: np.ndarray,
    start: int,
    painted: np.ndarray | None = None,
    erased: tuple[tuple[int, ...], ...] = (),
    stroke_table: np.ndarray | None = None,
) -> np.ndarray:
    """Return the labels of a section's frames.

    Parameters
    ----------
    masks : uint16 (T, y, x)
        Objects of the section; 0 = background.
    objects : int (section object,)
        What `table` calls each object of the section; that of the background is not in it.
    table : int32 (run, 3)
        See `label_table`.
    start : int
        Frame of the sequence with which the section starts.
    painted : int32 (T, y, x), optional
        Number of the strokes on each pixel; 0 erased, `UNTOUCHED`, or below it ``UNTOUCHED - n`` where only the objects
        of the n-th entry of `erased` are erased.
    erased : tuple of tuple of int
        Numbers of strokes.
    stroke_table : int32 (run, 3), optional
        As `table`, for numbers of strokes.

    Returns
    -------
    uint16 (T, y, x)
        0 static, else an identity.
    """
    labels = np.empty(masks.shape, np.uint16)
    # Of a long video, a section has few objects.
    table = table[np.isin(table[:, 0], objects)]
    # Frame by frame, because NumPy converts labels that index an array to integers of four times their size.
    for t, (mask, out) in enumerate(zip(masks, labels, strict=True)):
        label_of = labels_at(table, start + t)
        out[:] = np.array([label_of.get(int(each), 0) for each in objects], np.uint16)[mask]
        if painted is None or painted[t].max() == painted[t].min() == UNTOUCHED:
            continue
        label_of = {0: 0, **labels_at(stroke_table, start + t)}
        for number in np.unique(painted[t]).tolist():
            if number >= 0:
                out[painted[t] == number] = label_of[number]
            elif number < UNTOUCHED:
                gone = [label_of[each] for each in erased[UNTOUCHED - 1 - number]]
                out[(painted[t] == number) & np.isin(out, gone)] = 0
    return labels


def labels_at(table: np.ndarray, frame: int) -> dict[int, int]:
    """Return the label of each object, or number of strokes, of a table in a frame."""
    # Rows of one object follow each other in time, so the last one that has begun remains.
    return {key: label for key, first, label in table.tolist() if first <= frame}
