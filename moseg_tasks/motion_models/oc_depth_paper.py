"""The flow and depth model with the signs printed in the paper: eight parameters, for comparison.

u = a + b rho - c x rho - d y + e x² - f xy
v = g + h rho - c y rho - d x + e xy + f y²

Rotation about the optical axis contributes -d y to u and d x to v, and rotation about the x axis contributes f xy and
f y² with the same sign: this form cannot represent a part of either. ``benchmarks/rigid_flow.py`` measures how much.
"""

from moseg.tasks.motion_models.flow_model import FlowModel, terms_matrix

_PARAMETERS = tuple("abcdefgh")

OC_DEPTH_PAPER = FlowModel(
    name="oc_depth_paper",
    parameters=_PARAMETERS,
    u_terms=terms_matrix(
        _PARAMETERS,
        {"a": (1, "1"), "b": (1, "r"), "c": (-1, "xr"), "d": (-1, "y"), "e": (1, "xx"), "f": (-1, "xy")},
    ),
    v_terms=terms_matrix(
        _PARAMETERS,
        {"g": (1, "1"), "h": (1, "r"), "c": (-1, "yr"), "d": (-1, "x"), "e": (1, "xy"), "f": (1, "yy")},
    ),
    uses_depth=True,
    has_free_shift=False,
)
