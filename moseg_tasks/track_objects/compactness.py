"""Compactness of a group of tracks: a body fills its place, while slips of the tracker lie among other tracks."""

import cv2
import numpy as np

_LEAST = 3
"""Tracks of a group in a frame below which they enclose nothing."""


def enclosed_share(points: np.ndarray, visible: np.ndarray, members: np.ndarray) -> float:
    """Return the share of a group's own tracks among those inside its convex hull, median over the frames.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    members : bool (track,)
        Which tracks belong to the group.

    Returns
    -------
    float
        0 to 1; 0 if no frame shows three of its tracks.
    """
    shares = []
    for frame in range(visible.shape[1]):
        seen = visible[:, frame]
        if np.count_nonzero(seen & members) < _LEAST:
            continue
        place = points[seen, frame].astype(np.float32)
        hull = cv2.convexHull(place[members[seen]])
        is_inside = np.fromiter((cv2.pointPolygonTest(hull, xy, False) >= 0 for xy in place.tolist()), bool, len(place))
        shares.append((is_inside & members[seen]).sum() / max(is_inside.sum(), 1))
    return float(np.median(shares)) if shares else 0.0
