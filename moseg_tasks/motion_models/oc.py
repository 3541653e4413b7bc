"""The full quadratic flow model without depth: twelve parameters.

u = a + b x + c y + d x² + e xy + f y²
v = g + h x + i y + j x² + k xy + l y²

It represents the motion of a plane exactly and that of a shallow object approximately.

References
----------
E. Meunier, A. Badoual and P. Bouthemy, "EM-driven unsupervised learning for efficient motion segmentation",
IEEE TPAMI, 2023.
"""

from moseg.tasks.motion_models.flow_model import FlowModel, terms_matrix

_PARAMETERS = tuple("abcdefghijkl")
_QUADRATIC = ("1", "x", "y", "xx", "xy", "yy")

OC = FlowModel(
    name="oc",
    parameters=_PARAMETERS,
    u_terms=terms_matrix(_PARAMETERS, {p: (1, m) for p, m in zip("abcdef", _QUADRATIC, strict=True)}),
    v_terms=terms_matrix(_PARAMETERS, {p: (1, m) for p, m in zip("ghijkl", _QUADRATIC, strict=True)}),
    uses_depth=False,
    has_free_shift=True,
)
