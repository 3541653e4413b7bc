"""Outlines at full size: the foreground of a coarse grid is aligned with the edges of the frame."""

import cv2
import numpy as np

from moseg.schemas.parameters import LocalColourParams, RefinementParams
from moseg.tasks.frame_grid import resample
from moseg.tasks.proposals.components import FOREGROUND
from moseg.tasks.proposals.guided_filter import apply_coefficients, guided_coefficients
from moseg.tasks.proposals.local_colours import local_colour_ratio
from moseg.tasks.saliency.logits import logit, probability

_FILLED = 0.75  # probability of the holes of objects that belong to them
_MARGIN = 4  # cells around the objects that are processed, in addition to the filter's two windows


def refine_outlines(
    frame: np.ndarray,
    labels: np.ndarray,
    foreground: np.ndarray,
    params: RefinementParams,
    colours: LocalColourParams | None = None,
) -> np.ndarray:
    """Return the objects of a frame at its full size.

    Parameters
    ----------
    frame : uint8 (Y, X, 3)
        RGB.
    labels : uint16 (h, w)
        Objects on the working grid, 0 = background. Where the foreground is below a half they were filled.
    foreground : float32 (h, w)
        Probability to move, 0..1.
    params : RefinementParams
    colours : LocalColourParams, optional
        Without them the foreground alone is aligned.

    Returns
    -------
    objects : uint16 (Y, X)
        Where the filtered foreground is over a half, the nearest object within two cells.
    """
    height, width = frame.shape[:2]
    objects = np.zeros((height, width), np.uint16)
    window = _window_around(labels > 0, 2 * params.radius + _MARGIN)
    if window is None:
        return objects
    rows, columns = window
    scale_y, scale_x = height / labels.shape[0], width / labels.shape[1]
    full_rows = slice(round(rows.start * scale_y), round(rows.stop * scale_y))
    full_columns = slice(round(columns.start * scale_x), round(columns.stop * scale_x))
    part = frame[full_rows, full_columns]
    if part.size == 0:
        return objects
    near = labels[window]
    moves = np.where((near > 0) & (foreground[window] <= FOREGROUND), _FILLED, foreground[window]).astype(np.float32)
    # Foreground of no object, such as a dropped component, must not leak into an object.
    kept = np.where((near > 0) | (moves <= FOREGROUND), moves, np.float32(0))
    image = resample(part, near.shape)
    if colours is not None and colours.share:
        origin = (rows.start, columns.start)
        ratio = local_colour_ratio(image, moves, near > 0, colours, origin)
        kept = probability(logit(kept) + np.float32(colours.share) * ratio)
    guide = image * np.float32(1 / 255)
    slope, offset = guided_coefficients(guide, kept, params.radius, params.smoothness)
    soft = apply_coefficients(part.astype(np.float32) * np.float32(1 / 255), slope, offset)
    nearest = cv2.resize(_grow(near), part.shape[1::-1], interpolation=cv2.INTER_NEAREST)
    objects[full_rows, full_columns] = np.where(soft > FOREGROUND, nearest, 0)
    return objects


def _window_around(mask: np.ndarray, margin: int) -> tuple[slice, slice] | None:
    """Return rows and columns around a mask, with a margin inside the frame; None where it is empty."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if not len(rows):
        return None
    return (
        slice(max(int(rows[0]) - margin, 0), min(int(rows[-1]) + margin + 1, mask.shape[0])),
        slice(max(int(columns[0]) - margin, 0), min(int(columns[-1]) + margin + 1, mask.shape[1])),
    )


def _grow(labels: np.ndarray) -> np.ndarray:
    """Extend labels a cell or two beyond the objects: a filtered outline may lie there."""
    grown = labels
    for _ in range(2):
        grown = np.where(grown > 0, grown, cv2.dilate(grown, np.ones((3, 3), np.uint8)))
    return grown
