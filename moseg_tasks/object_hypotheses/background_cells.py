"""The background cut into cells of the frame: parts that are known to move alike, about as large as objects."""

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
