"""Static by agreement: an object is dropped only where every view says that it is background."""

from collections.abc import Sequence

import numpy as np


def agreed_static(supports: Sequence[np.ndarray], threshold: float) -> np.ndarray:
    """Which objects every view takes for background, bool (K,); the background always.

    An average of views would drop what one view is blind to and another cannot tell: trajectories do not see motion
    along epipolar lines, and flow whose background fits badly sees nothing small. A view that does not know an object,
    or does not know it well enough, does not agree. What no view knows at all is static, for nothing says that it
    moves: specks too small for any model.

    Parameters
    ----------
    supports : sequence of float64 (K,)
        Each view's ``static_support``; NaN where unknown.
    threshold : float
        Least support that counts as a yes.
    """
    votes = np.stack(supports)
    agreed = (votes >= threshold).all(axis=0) | np.isnan(votes).all(axis=0)
    agreed[0] = True
    return agreed


def set_apart(views: np.ndarray, is_static: np.ndarray) -> np.ndarray:
    """Affinities (V, K, K) with all static objects alike and none like any other object."""
    same = is_static[:, None] == is_static[None, :]
    static = is_static[:, None] & is_static[None, :]
    return np.where(static, 1.0, np.where(same, views, 0.0))
