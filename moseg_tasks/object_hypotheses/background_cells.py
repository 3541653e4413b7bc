"""Cells of the background: parts known to share one motion, and the unit that their affinities give to ranks."""

import numpy as np

from moseg.schemas.parameters import ObjectHypothesisParams


def background_cells(image_shape: tuple[int, int], params: ObjectHypothesisParams) -> np.ndarray:
    """Cell of each pixel, row by row: int64 (H, W).

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
    """Node of each pixel or track: its object, or from K on the background's cell that it lies in.

    Parameters
    ----------
    owner : unsigned integer (...)
        Object, 0 = background.
    cell : int64 (...)
        Of ``background_cells``, at the same places.
    num_objects : int
        K, the background included.

    Returns
    -------
    uint16 (...)
        Nothing is of node 0 any more.
    """
    return np.where(owner == 0, num_objects + cell, owner).astype(np.uint16)


def scale_by_background(kernel: np.ndarray, num_objects: int, params: ObjectHypothesisParams) -> np.ndarray:
    """Affinity between objects in units of the affinity between the background's cells.

    A rank has no scale: two objects of one motion share a few or most of their preferred hypotheses, according to the
    noise, to the scene's depth and to how many hypotheses are of their motion. All of this holds for the background's
    cells too, and these are known to move as one: they set the unit. An object is as alike to the background as to the
    cell that is most like it, for cells at other depths tell nothing.

    Parameters
    ----------
    kernel : float64 (N, N)
        Of ``preference_kernel``; nodes 0 .. K - 1 are objects, node 0 (the whole background) is not read, the others
        are the background's cells. NaN where unknown.
    num_objects : int
        K.
    params : ObjectHypothesisParams
        `scale_quantile` is read.

    Returns
    -------
    float64 (K, K)
        In 0..1, symmetric, 1 on the diagonal. NaN where unknown: for an object that is never seen, for two never seen
        together, and between all where fewer than two cells are known or none is like another.
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
    """Elementwise geometric mean of two arrays of affinities in 0..1; where one is NaN the other stands alone."""
    known0, known1 = np.isfinite(values0), np.isfinite(values1)
    mean = np.sqrt(np.where(known0, values0, 1.0) * np.where(known1, values1, 1.0))
    return np.where(known0 & known1, mean, np.where(known0, values0, values1))


def _greatest(values: np.ndarray) -> np.ndarray:
    """Largest known value of each column; NaN where none is."""
    largest = np.where(np.isnan(values), -np.inf, values).max(axis=0, initial=-np.inf)
    return np.where(np.isfinite(largest), largest, np.nan)
