"""Two-view geometry: fundamental matrices of objects, their degeneracies and residuals."""

from moseg.tasks.geometry.coordinates import normalise_points, normalising_transform, pixel_scale
from moseg.tasks.geometry.degeneracy import Degeneracy
from moseg.tasks.geometry.fit import FundamentalFits, ModelKind, fit_fundamentals
from moseg.tasks.geometry.residuals import fundamental_residuals

__all__ = [
    "Degeneracy",
    "FundamentalFits",
    "ModelKind",
    "fit_fundamentals",
    "fundamental_residuals",
    "normalise_points",
    "normalising_transform",
    "pixel_scale",
]
