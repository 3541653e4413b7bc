"""Cells of the background: parts known to share one motion, and the unit that their affinities give to ranks."""

import numpy as np

from moseg.schemas.parameters import ObjectHypothesisParams


def background_cells(image_shape: tuple[int, int], params: ObjectHypothesisParams) -> np.ndarray:
    """Return the cell of each pixel, numbered row by row: int64 (H, W).

    Parameters
    ----------
    image_shape : (int, int)
        Height and width, px.
    params : ObjectHypothesisParams
        `background_rows` and `background_columns` are read.
    """
    height, width = image_shape
    rows = np.arange(height) * params.background_rows // height
    columns = np.arange(width) * params.background_columns // width
    return rows[:, None] * params.background_columns + columns[None, :]


def split_background(owner: np.ndarray, cell: np.ndarray, num_objects: int) -> np.ndarray:
    """Return the node of each pixel or track: its object, or K plus the background's cell that contains it.

    Parameters
    ----------
    owner : unsigned integer (...)
        Object, 0 = background.
    cell : int64 (...)
        From ``background_cells``, of the same pixels or tracks.
    num_objects : int
        K, the background included.

    Returns
    -------
    uint16 (...)
        No element is of node 0.
    """
    return np.where(owner == 0, num_objects + cell, owner).astype(np.uint16)


def scale_by_background(kernel: np.ndarray, num_objects: int, params: ObjectHypothesisParams) -> np.ndarray:
    """Return the affinity between objects in units of the affinity between the background's cells.

    A rank has no scale: two objects of one motion share few or most of their preferred hypotheses, depending on the
    noise, the scene's depth and the number of hypotheses of their motion. The same is true of the background's cells,
    which are known to share one motion: they define the unit. The affinity of an object to the background is that to
    the most similar cell, because cells at other depths are not informative.

    Parameters
    ----------
    kernel : float64 (N, N)
        From ``preference_kernel``; nodes 0 .. K - 1 are objects, node 0 (the whole background) is not read, the others
        are the background's cells. NaN if unknown.
    num_objects : int
        K.
    params : ObjectHypothesisParams
        `scale_quantile` is read.

    Returns
    -------
    float64 (K, K)
        In 0..1, symmetric, 1 on the diagonal. NaN if unknown: for an object that is never visible, for two never
        visible together, and between all objects if fewer than two cells are known or none is like another.
    """
    affinity = np.full((num_objects, num_objects), np.nan)
    cells = num_objects + np.flatnonzero(np.isfinite(np.diag(kernel)[num_objects:]))
    between = kernel[np.ix_(cells, cells)].copy()
    np.fill_diagonal(between, np.nan)
    nearest = _greatest(between)
    nearest = nearest[np.isfinite(nearest)]
    unit = float(np.quantile(nearest, params.scale_quantile)) if len(nearest) else 0.0
    if unit > 0:
        affinity[1:, 1:] = kernel[1:num_objects, 1:num_objects]
        affinity[0, 1:] = affinity[1:, 0] = _greatest(kernel[np.ix_(cells, np.arange(1, num_objects))])
        affinity = np.minimum(affinity / unit, 1.0)
    known = np.isfinite(np.diag(kernel)[:num_objects])
    known[0] = len(cells) > 0
    np.fill_diagonal(affinity, np.where(known, 1.0, np.nan))
    return affinity


def geometric_mean(values0: np.ndarray, values1: np.ndarray) -> np.ndarray:
    """Return the elementwise geometric mean of two arrays of affinities in 0..1; if one is NaN, the other."""
    known0, known1 = np.isfinite(values0), np.isfinite(values1)
    mean = np.sqrt(np.where(known0, values0, 1.0) * np.where(known1, values1, 1.0))
    return np.where(known0 & known1, mean, np.where(known0, values0, values1))


def _greatest(values: np.ndarray) -> np.ndarray:
    """Return the largest known value of each column; NaN if there is none."""
    largest = np.where(np.isnan(values), -np.inf, values).max(axis=0, initial=-np.inf)
    return np.where(np.isfinite(largest), largest, np.nan)
