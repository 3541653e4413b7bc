"""Parametric flow models of the displacements of points, with and without depth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike

from moseg.tasks.motion_models import FlowModel
from moseg.tasks.motion_models.monomials import evaluate_monomials
from moseg.tasks.point_models.blocks import combine_products, sum_of_squares
from moseg.tasks.point_models.correspondences import Correspondences, checked, checked_for_fit

_TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True)
class FlowPointModel:
    """x1 - x0 = design(x0, inverse depth) theta, linear in the P parameters of a flow model.

    The parameters refer to px from the principal point (without depth and principal point: from pixel (0, 0), which has
    no effect on the quadratic model) and to the inverse depth as given.

    Attributes
    ----------
    flow_model : FlowModel
    min_conditioning : float
        Smallest ratio of the last to the first singular value of the design, its columns scaled to unit length, for
        points that determine the model.
    """

    flow_model: FlowModel
    min_conditioning: float = 1e-4
    num_frames: int = 2

    @property
    def name(self) -> str:
        return self.flow_model.name

    @property
    def sample_size(self) -> int:
        """Fewest points whose equations, two each, are at least as many as the parameters."""
        return -(-self.flow_model.num_parameters // 2)

    @property
    def needs_depth(self) -> bool:
        return self.flow_model.uses_depth

    def fit(self, data: Correspondences) -> np.ndarray:
        """Return float64 (..., P) of smallest squared displacement error."""
        data = checked_for_fit(data, self.num_frames, self.needs_depth, self.sample_size)
        design, column_scale = self._scaled_design(data)
        displacement = (data.points[..., 1, :] - data.points[..., 0, :]).reshape(*data.points.shape[:-3], -1)
        q, r = np.linalg.qr(design)
        # Columns that depend on earlier ones are ignored, so that undetermined models stay finite.
        diagonal = np.abs(np.diagonal(r, axis1=-2, axis2=-1))
        dependent = diagonal <= np.finfo(np.float64).eps * design.shape[-2]
        r = np.where(dependent[..., None], np.eye(r.shape[-1]), r)
        target = np.where(dependent, 0.0, (np.swapaxes(q, -1, -2) @ displacement[..., None])[..., 0])
        return np.linalg.solve(r, target[..., None])[..., 0] / column_scale

    def residual(self, parameters: np.ndarray, data: Correspondences, dtype: DTypeLike = np.float64) -> np.ndarray:
        """Return the squared length of the displacement error, px^2 (..., H, N).

        As in optical flow, all of the error is in the second frame: twice the squared Sampson distance for a small
        motion.
        """
        data = checked(data, self.num_frames, self.needs_depth)
        monomials = self._monomials(data)
        displacement = np.swapaxes(data.points[..., 1, :] - data.points[..., 0, :], -1, -2)
        factors = []
        for component, terms in enumerate((self.flow_model.u_terms, self.flow_model.v_terms)):
            minus_one = np.full((*parameters.shape[:-1], 1), -1.0)
            rows = np.concatenate([monomials, displacement[..., component : component + 1, :]], axis=-2)
            factors.append((np.concatenate([parameters @ terms.T, minus_one], axis=-1), rows))
        return combine_products(factors, sum_of_squares, 0, dtype)

    def degenerate(self, data: Correspondences) -> np.ndarray:
        """Return whether the points are too few or have more than one solution: bool (...).

        Without depth these are points on one conic, and so on a line; with depth, also points of dependent depth.
        """
        data = checked(data, self.num_frames, self.needs_depth)
        if data.num_points < self.sample_size:
            return np.ones(data.points.shape[:-3], dtype=bool)
        singular = np.linalg.svd(self._scaled_design(data)[0], compute_uv=False)
        return singular[..., -1] < self.min_conditioning * singular[..., 0]

    def _scaled_design(self, data: Correspondences) -> tuple[np.ndarray, np.ndarray]:
        """Return the design (..., 2 N, P) with columns of unit length, and their lengths in pixels (..., P)."""
        monomials = np.swapaxes(self._monomials(data), -1, -2)
        design = np.stack([monomials @ self.flow_model.u_terms, monomials @ self.flow_model.v_terms], axis=-2)
        design = design.reshape(*data.points.shape[:-3], -1, self.flow_model.num_parameters)
        lengths = np.linalg.norm(design, axis=-2)
        lengths = np.where(lengths > _TINY, lengths, 1.0)
        return design / lengths[..., None, :], lengths

    def _monomials(self, data: Correspondences) -> np.ndarray:
        """Return the monomials of every point in the first frame, (..., 9, N)."""
        centre = (0.0, 0.0) if data.principal_point is None else data.principal_point
        x, y = np.moveaxis(data.points[..., 0, :] - np.asarray(centre, dtype=np.float64), -1, 0)
        depth = data.inverse_depth if self.needs_depth else np.zeros_like(x)
        return np.swapaxes(evaluate_monomials(x, y, depth), -1, -2)
