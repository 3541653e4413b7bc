"""The interface of motion models of point correspondences: fit and residuals."""

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import DTypeLike

from moseg.tasks.point_models.correspondences import Correspondences


@runtime_checkable
class PointModel(Protocol):
    """A motion model of points tracked over two or three frames.

    All methods raise InputError if the data has another shape than the model requires. Hypotheses of samples that do
    not determine the model are kept, because few trajectories agree with them; the models of this package recognise
    such samples (``degenerate``) for tests and benchmarks.

    Attributes
    ----------
    name : str
    num_frames : int
        Frames of a correspondence.
    sample_size : int
        Points of a minimal sample, the fewest that `fit` accepts.
    needs_depth : bool
        Whether `inverse_depth` and `principal_point` are required.
    """

    @property
    def name(self) -> str: ...

    @property
    def num_frames(self) -> int: ...

    @property
    def sample_size(self) -> int: ...

    @property
    def needs_depth(self) -> bool: ...

    def fit(self, data: Correspondences) -> np.ndarray:
        """Fit the model to each point set: exactly to a minimal sample, by least squares to more points.

        Returns
        -------
        parameters : float64 (..., *P)
            In pixel coordinates. Arbitrary but finite if the points do not determine the model.
        """
        ...

    def residual(self, parameters: np.ndarray, data: Correspondences, dtype: DTypeLike = np.float64) -> np.ndarray:
        """Return the squared distance of every point set of `data` to every model, by matrix products.

        Parameters
        ----------
        parameters : float64 (..., H, *P)
        data : Correspondences
            points (..., N, F, 2), px.
        dtype : float64 or float32
            Precision of the computation and of the result; float32 takes about two thirds of the time. All but one in
            ten thousand distances above 0.05 px are within 0.1 %; the others are of nearly degenerate models.

        Returns
        -------
        squared : (..., H, N)
            px^2.
        """
        ...
