"""Static objects: those that a rigid scene explains, or, where this is not known, by agreement of all views."""

from collections.abc import Sequence

import numpy as np


def agreed_static(
    supports: Sequence[np.ndarray], threshold: float, rigid_support: np.ndarray | None = None
) -> np.ndarray:
    """Return which objects are background in every view, bool (K,); the background always is.

    An average of views would drop objects whose motion one view cannot measure: trajectories do not detect motion along
    epipolar lines, and flow does not detect small motions if the background fits badly. A view in which an object's
    support is unknown, or too low, does not agree. Objects unknown to all views, too small for any model, are static:
    there is no evidence that they move.

    Parameters
    ----------
    supports : sequence of float64 (K,)
        Each view's ``static_support``; NaN if unknown.
    threshold : float
        Smallest support that counts as agreement.
    rigid_support : float64 (K,), optional
        Support for being part of the rigid scene (``combine_sections``). Where it is known it decides alone, because it
        compares each object with all static points at any depth, which no view without depth can; NaN if unknown.
    """
    votes = np.stack(supports)
    agreed = (votes >= threshold).all(axis=0) | np.isnan(votes).all(axis=0)
    if rigid_support is not None:
        agreed = np.where(np.isnan(rigid_support), agreed, rigid_support >= threshold)
    agreed[0] = True
    return agreed


def set_apart(views: np.ndarray, is_static: np.ndarray) -> np.ndarray:
    """Return affinities (V, K, K) that are 1 between static objects and 0 between static and other objects."""
    same = is_static[:, None] == is_static[None, :]
    static = is_static[:, None] & is_static[None, :]
    return np.where(static, 1.0, np.where(same, views, 0.0))
