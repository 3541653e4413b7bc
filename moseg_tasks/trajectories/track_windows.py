"""Windows of frames, and the trajectories that span them."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import CodingParams


class TrackWindow(NamedTuple):
    """Some frames of a clip and the trajectories that span them.

    Attributes
    ----------
    tracks : int (n,)
        Indices of the trajectories.
    points : float64 (n, frame, xy)
        px, at frames evenly spaced over the window; interpolated where a trajectory is hidden
        for less than twice the spacing of these frames.
    length : int
        Number of frames of the window.
    """

    tracks: np.ndarray
    points: np.ndarray
    length: int


def track_windows(points: np.ndarray, visible: np.ndarray, params: CodingParams) -> list[TrackWindow]:
    """Return overlapping windows of a clip, shorter than the median trajectory, so that many span each.

    A window is the whole clip if the median trajectory is complete. Windows start half a window after each other, and
    the last ends with the clip; those that fewer than `params.min_tracks` trajectories span are left out. A clip of
    fewer than `params.min_frames` has none: trajectories so short tell where a point is, not how it moves.

    Parameters
    ----------
    points : float (N, frame, xy)
        px.
    visible : bool (N, frame)
    params : CodingParams
    """
    num_frames = visible.shape[1]
    order = np.arange(num_frames)
    before = np.maximum.accumulate(np.where(visible, order, -1), axis=1)
    after = np.minimum.accumulate(np.where(visible, order, num_frames)[:, ::-1], axis=1)[:, ::-1]
    seen = after[:, 0] < num_frames
    if not seen.any() or num_frames < params.min_frames:
        return []
    span = int(np.median((before[:, -1] - after[:, 0] + 1)[seen]))
    length = num_frames if span == num_frames else max(params.min_frames, int(params.window_share * span))
    length = min(num_frames, length)
    starts = [*range(0, num_frames - length, max(1, length // 2)), num_frames - length]
    # In the middle of equal parts, so that a trajectory that starts a little later still counts.
    count = min(params.num_frames, length)
    inside = ((np.arange(count) + 0.5) * length / count).astype(int)
    windows = (_window(points, before, after, start + inside, length) for start in starts)
    return [window for window in windows if len(window.tracks) >= params.min_tracks]


def _window(points: np.ndarray, before: np.ndarray, after: np.ndarray, frames: np.ndarray, length: int) -> TrackWindow:
    """Return the points of some frames, from the nearest frames before and after that show them, int (N, frame)."""
    max_hidden = 2 * -(-length // len(frames))
    before, after = before[:, frames], after[:, frames]
    is_known = (before >= 0) & (after < points.shape[1]) & (after - before <= max_hidden)
    tracks = np.flatnonzero(is_known.all(axis=1))
    before, after = before[tracks], after[tracks]
    weight = np.divide(frames - before, after - before, out=np.zeros(before.shape), where=after > before)[..., None]
    rows = tracks[:, None]
    return TrackWindow(tracks, (1 - weight) * points[rows, before] + weight * points[rows, after], length)
