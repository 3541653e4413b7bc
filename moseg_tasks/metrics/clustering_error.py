"""The share of items that a clustering assigns to a wrong group."""

import numpy as np
from scipy.optimize import linear_sum_assignment

from moseg.schemas.errors import InputError


def clustering_error(predicted: np.ndarray, truth: np.ndarray) -> float:
    """Return the share of items outside the group of their label, under the best one-to-one matching of both.

    The values of groups and labels do not matter. With more groups than labels, or fewer, all items of those without a
    partner are wrong.

    Parameters
    ----------
    predicted : integer (N,)
        Group of each item.
    truth : integer (N,)
        Label of each item.

    Returns
    -------
    float
        Percent.

    Raises
    ------
    InputError
        If there is no item or the two disagree in length.

    References
    ----------
    R. Tron and R. Vidal, "A benchmark for the comparison of 3-D motion segmentation algorithms", CVPR 2007.
    """
    if np.ndim(truth) != 1 or np.shape(predicted) != np.shape(truth) or not len(truth):
        got = f"{np.shape(predicted)} groups and {np.shape(truth)} labels"
        raise InputError("nothing to compare", where="clustering_error", got=got, expected="as many, one or more")
    groups, labels = (np.unique(values, return_inverse=True)[1] for values in (predicted, truth))
    shared = np.zeros((groups.max() + 1, labels.max() + 1), dtype=np.int64)
    np.add.at(shared, (groups, labels), 1)
    rows, columns = linear_sum_assignment(shared, maximize=True)
    return 100.0 * float(len(truth) - shared[rows, columns].sum()) / len(truth)
