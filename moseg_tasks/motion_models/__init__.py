"""Parametric flow models, their least-squares fits and the residuals of each object under each fit."""

from moseg.tasks.motion_models.fit import fit_from_moments, flow_energy, residuals_from_moments
from moseg.tasks.motion_models.flow_model import FlowModel
from moseg.tasks.motion_models.moments import Moments, flow_moments, unpack_moments
from moseg.tasks.motion_models.registry import FLOW_MODELS

__all__ = [
    "FLOW_MODELS",
    "FlowModel",
    "Moments",
    "fit_from_moments",
    "flow_energy",
    "flow_moments",
    "residuals_from_moments",
    "unpack_moments",
]
