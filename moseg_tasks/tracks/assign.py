"""Assignment of objects to tracks without one."""

import numpy as np

from moseg.schemas.errors import InputError
from moseg.tasks.tracks.labels_at import OUTSIDE, labels_at


def assign_tracks(points: np.ndarray, visible: np.ndarray, masks: np.ndarray) -> np.ndarray:
    """Return the object under each track in most of the frames in which it is visible.

    Parameters
    ----------
    points : float32 (N, F, 2)
        xy, px.
    visible : bool (N, F)
    masks : uint16 (M, y, x)
        Objects in the first M <= F frames, 0 = background.

    Returns
    -------
    object : uint16 (N,)
        Of equally frequent objects the lower one; 0 for tracks not visible in any frame that has a mask.

    Raises
    ------
    InputError
        There are fewer frames than masks.
    """
    num_tracks, num_frames = visible.shape
    if len(masks) > num_frames:
        raise InputError("more masks than frames", where="masks", got=len(masks), expected=f"at most {num_frames}")
    num_labels = 1 + max((int(mask.max(initial=0)) for mask in masks), default=0)
    votes = np.zeros((num_tracks, num_labels), dtype=np.int64)
    for frame_index, mask in enumerate(masks):
        seen = np.flatnonzero(visible[:, frame_index])
        labels = labels_at(mask, points[seen, frame_index])
        inside = labels != OUTSIDE
        votes[seen[inside], labels[inside]] += 1
    return votes.argmax(axis=1).astype(np.uint16)
