"""Masks of what may be static, beside the moving objects: every pixel takes the label of its nearest track."""

import cv2
import numpy as np

from moseg.schemas.parameters import TrackSurfaceParams

_STEP = 2  # spacing of the grid on which pixels are labelled, px


def surface_masks(
    shape: tuple[int, int],
    points: np.ndarray,
    visible: np.ndarray,
    labels: np.ndarray,
    frames: range,
    params: TrackSurfaceParams,
) -> np.ndarray:
    """Return the label of every pixel.

    Outlines are those of the tracks alone: what may be static is only compared with what is around it.

    Parameters
    ----------
    shape : (height, width)
        Of the frames, px.
    points : float32 (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    labels : uint16 (track,)
        0 = none.
    frames : range
        Frames of the tracks to label.
    params : TrackSurfaceParams
        `mask_radius` is read.

    Returns
    -------
    uint16 (frame, y, x)
        0 = none.
    """
    height, width = shape
    grid = -(-height // _STEP), -(-width // _STEP)
    masks = np.zeros((len(frames), height, width), np.uint16)
    for row, frame in enumerate(frames):
        seen = np.flatnonzero(visible[:, frame])
        if not labels[seen].any():
            continue
        far = np.full(grid, 255, np.uint8)
        # A cell of the grid stands for the pixels around its middle.
        cells = np.rint((points[seen, frame] - (_STEP - 1) / 2) / _STEP).astype(int)
        cells = np.clip(cells, 0, [grid[1] - 1, grid[0] - 1])
        far[cells[:, 1], cells[:, 0]] = 0
        distance, nearest = cv2.distanceTransformWithLabels(far, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
        label_of = np.zeros(nearest.max() + 1, np.uint16)
        label_of[nearest[cells[:, 1], cells[:, 0]]] = labels[seen]
        near = np.where(distance * _STEP <= params.mask_radius, label_of[nearest], 0)
        masks[row] = cv2.resize(near, (width, height), interpolation=cv2.INTER_NEAREST)
    return masks
