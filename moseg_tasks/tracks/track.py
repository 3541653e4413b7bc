"""Object-specific point tracks through one section of a video, by Lucas-Kanade."""

from collections.abc import Iterable, Sequence

import cv2
import numpy as np

from moseg.schemas.parameters import TrackParams
from moseg.tasks.tracks.assemble import Tracks, assemble_tracks
from moseg.tasks.tracks.front import NO_TRACKS, Front, check_front
from moseg.tasks.tracks.lucas_kanade import follow_points


def track_points(
    frames: Iterable[np.ndarray],
    masks: Sequence[np.ndarray] | np.ndarray,
    params: TrackParams,
    rng: np.random.Generator,
) -> Tracks:
    """Sample points in every object and track them.

    At the first frame and every `params.resample_every` frames, points outside their object's mask are dropped (their
    tracks end there) and new ones are sampled until each object has its quota again, so that an object that enters gets
    points at the next check. A track ends where its point is lost or near the frame's border.

    The paper tracks points by PIPs (`track_points_pips`); this is pyramidal Lucas-Kanade with a forward-backward check,
    which needs no weights.

    Parameters
    ----------
    frames : iterable of uint8 (y, x, 3)
        RGB, F frames; read once, in order.
    masks : uint16 (M, y, x)
        Objects in the first M <= F frames, 0 = background, which gets points as well. Later frames only extend tracks.
    params : TrackParams
    rng : numpy.random.Generator

    Returns
    -------
    Tracks
        In order of first frame, then object.

    Raises
    ------
    InputError
        A frame and its mask differ in size, or there are fewer frames than masks.
    """
    front = NO_TRACKS
    fronts: list[Front] = []
    previous = None
    for frame_index, frame in enumerate(frames):
        gray = cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY)
        if previous is not None:
            front = front.move(*follow_points(previous, gray, front.points, params))
        if frame_index < len(masks) and frame_index % params.resample_every == 0:
            front = check_front(front, frame_index, frame, masks[frame_index], params, rng)
        fronts.append(front)
        previous = gray
    return assemble_tracks(fronts, len(masks))
