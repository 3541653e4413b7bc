"""What a file holds, as labels of a frame."""

import numpy as np

from moseg.schemas.errors import InputError


def as_labels(values: np.ndarray, shape: tuple[int, int], where: object) -> np.ndarray:
    """Values read from a file as uint16 (y, x), in a new array.

    Parameters
    ----------
    values : bool, integer or float (y, x)
        Floats must be whole numbers: labels that were interpolated are none.
    shape : (int, int)
        Height and width that the frame must have, px.
    where : object
        File, for the error.

    Raises
    ------
    InputError
        Where the size is another or the values are no labels 0..65535.
    """
    if values.shape != shape:
        raise InputError("wrong size of masks", where=where, got=values.shape, expected=shape)
    if values.dtype.kind not in "biuf":
        raise InputError("masks that are no labels", where=where, got=values.dtype, expected="integers 0..65535")
    with np.errstate(invalid="ignore"):
        labels = values.astype(np.uint16)
    if values.dtype.kind != "b" and not np.array_equal(labels, values):
        bad = values[labels != values].flat[0]
        raise InputError("masks that are no labels", where=where, got=bad, expected="integers 0..65535")
    return labels
