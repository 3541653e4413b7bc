"""What a report shows as figures: matrices as heat maps, eigenvalues as a plot."""

from typing import NamedTuple

import numpy as np


class Matrix(NamedTuple):
    """A square matrix over the objects of a sequence, or over a sample of its tracks.

    Attributes
    ----------
    title : str
        For instance ``residuals, trajs``.
    values : float64 (k, k)
        NaN where there is none.
    labels : tuple of str
        Of rows and columns alike: ``background``, then identities. Empty where there are too many to name.
    unit : str
        Empty for a pure number.
    description : str
        One sentence: what row and column are, and what a large value means.
    is_log : bool
        Whether colours go by the logarithm: residuals span decades.
    """

    title: str
    values: np.ndarray
    labels: tuple[str, ...]
    unit: str = ""
    description: str = ""
    is_log: bool = False


class EigenvaluePlot(NamedTuple):
    """The eigenvalues behind the number of motions.

    Attributes
    ----------
    eigenvalues : float64 (n,) or (V, n)
        Of the normalised affinity that the groups were cut from, in the order in which they were used; a row for each
        view where they were not made one kernel.
    num_motions : int
        Chosen, the background's included.
    how : str
        One sentence: how the number was chosen.
    """

    eigenvalues: np.ndarray
    num_motions: int
    how: str
