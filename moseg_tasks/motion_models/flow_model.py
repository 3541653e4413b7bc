"""Flow models: flow components that are linear in the parameters and in nine monomials."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from moseg.tasks.motion_models.monomials import MONOMIALS, evaluate_monomials


class FlowModel(NamedTuple):
    """A parametric flow model.

    Attributes
    ----------
    name : str
    parameters : tuple of str
        The P parameters' names, as in the equation.
    u_terms, v_terms : float64 (9, P)
        Coefficient of each monomial in the factor of each parameter: with m the monomials of a pixel,
        ``u = m @ u_terms @ theta`` and ``v = m @ v_terms @ theta``.
    uses_depth : bool
    has_free_shift : bool
        Whether adding a constant to the inverse depth leaves the set of expressible flows unchanged.
    """

    name: str
    parameters: tuple[str, ...]
    u_terms: np.ndarray
    v_terms: np.ndarray
    uses_depth: bool
    has_free_shift: bool

    @property
    def num_parameters(self) -> int:
        """Number of parameters, P."""
        return len(self.parameters)

    def design(self, x: np.ndarray, y: np.ndarray, rho: np.ndarray) -> np.ndarray:
        """Return the design rows of N points, float64 (N, 2, P): flow (u, v) is ``design @ theta``, px."""
        monomials = evaluate_monomials(x, y, rho)
        return np.stack([monomials @ self.u_terms, monomials @ self.v_terms], axis=1)


def terms_matrix(parameters: Sequence[str], terms: Mapping[str, tuple[float, str]]) -> np.ndarray:
    """Return the terms float64 (9, P) of one flow component from (sign, monomial) of each of its parameters."""
    matrix = np.zeros((len(MONOMIALS), len(parameters)))
    for parameter, (sign, monomial) in terms.items():
        matrix[MONOMIALS.index(monomial), parameters.index(parameter)] = sign
    matrix.setflags(write=False)
    return matrix
