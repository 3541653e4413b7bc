"""Tracks of the whole frame through a window of frames, refilled in each frame."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import DenseTrackParams
from moseg.tasks.dense_tracks.follow import follow_both_ways
from moseg.tasks.dense_tracks.thinning import first_in_cells, new_corners
from moseg.tasks.tracks.lucas_kanade import inside_border


class DenseTracks(NamedTuple):
    """Point tracks through F frames.

    Attributes
    ----------
    points : float32 (N, F, 2)
        xy, px; 0 where not visible.
    visible : bool (N, F)
        One run of consecutive frames per track.
    """

    points: np.ndarray
    visible: np.ndarray


def track_densely(
    frames: Iterable[np.ndarray], flows: Iterable[tuple[np.ndarray, np.ndarray]], params: DenseTrackParams
) -> DenseTracks:
    """Track corners of the whole frame, in every frame as many as there is room for.

    A small object that moves owns some per cent of the corners, so there are thousands of them. Frames are equalised
    first: corners in the shade of a car count as much as those of a sunlit wall.

    Parameters
    ----------
    frames : iterable of uint8 (y, x, 3)
        RGB, F frames of one size; read once, in order.
    flows : iterable of (float32 (y, x, 2), float32 (y, x, 2))
        F - 1 pairs, px/frame: from each frame to the next, and from the next back; finite.
    params : DenseTrackParams

    Returns
    -------
    DenseTracks
        In order of first frame; only those of `params.min_frames` or more.
    """
    flows = iter(flows)
    fronts: list[tuple[np.ndarray, np.ndarray]] = []
    live, points, num_tracks, previous = np.zeros(0, np.intp), np.zeros((0, 2), np.float32), 0, None
    for frame in frames:
        gray = _equalised(frame, params)
        if previous is not None:
            points, error = follow_both_ways(previous, gray, points, *next(flows), params)
            kept = np.flatnonzero((error < params.forward_backward) & inside_border(points, gray.shape, params.border))
            # Oldest first, so that a track that another one runs into goes on.
            kept = kept[first_in_cells(points[kept], params.spacing)]
            live, points = live[kept], points[kept]
        corners = new_corners(gray, points, params)
        live = np.concatenate([live, num_tracks + np.arange(len(corners))])
        points = np.concatenate([points, corners])
        num_tracks += len(corners)
        fronts.append((live, points))
        previous = gray
    return _assemble(fronts, num_tracks, params.min_frames)


def join_runs(runs: Sequence[DenseTracks], starts: Sequence[int], num_frames: int) -> DenseTracks:
    """Join the tracks of several runs of frames, of which each starts at its own frame, to those of `num_frames`."""
    if len(runs) == 1:
        return runs[0]
    num_tracks = [len(run.points) for run in runs]
    joined = DenseTracks(
        np.zeros((sum(num_tracks), num_frames, 2), np.float32), np.zeros((sum(num_tracks), num_frames), bool)
    )
    last = np.cumsum(num_tracks)
    for run, start, end in zip(runs, starts, last, strict=True):
        place = slice(end - len(run.points), end), slice(start, start + run.points.shape[1])
        joined.points[place], joined.visible[place] = run
    return joined


def _equalised(frame: np.ndarray, params: DenseTrackParams) -> np.ndarray:
    """Return the grey levels of an RGB frame, uint8 (y, x), with contrast equalised in tiles."""
    gray = cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY)
    tiles = (min(params.contrast_tiles, gray.shape[1]), min(params.contrast_tiles, gray.shape[0]))
    return cv2.createCLAHE(params.contrast, tiles).apply(gray)


def _assemble(fronts: list[tuple[np.ndarray, np.ndarray]], num_tracks: int, min_frames: int) -> DenseTracks:
    """Return the tracks of `min_frames` or more from the tracks (P,) and positions (P, 2) of each frame."""
    length = np.zeros(num_tracks, np.intp)
    for live, _ in fronts:
        length[live] += 1
    is_kept = length >= min_frames
    row = np.cumsum(is_kept) - 1
    tracks = DenseTracks(
        np.zeros((np.count_nonzero(is_kept), len(fronts), 2), np.float32),
        np.zeros((np.count_nonzero(is_kept), len(fronts)), bool),
    )
    for frame_index, (live, points) in enumerate(fronts):
        kept = is_kept[live]
        tracks.points[row[live[kept]], frame_index] = points[kept]
        tracks.visible[row[live[kept]], frame_index] = True
    return tracks
