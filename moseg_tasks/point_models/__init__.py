"""Motion models of point correspondences behind one interface: fits, residuals and degeneracies in batches."""

from moseg.tasks.point_models.correspondences import Correspondences
from moseg.tasks.point_models.point_model import PointModel
from moseg.tasks.point_models.registry import POINT_MODELS, point_model
from moseg.tasks.point_models.sample_residuals import sample_residuals
from moseg.tasks.point_models.trifocal_degeneracy import TrifocalDegeneracy

__all__ = [
    "POINT_MODELS",
    "Correspondences",
    "PointModel",
    "TrifocalDegeneracy",
    "point_model",
    "sample_residuals",
]
