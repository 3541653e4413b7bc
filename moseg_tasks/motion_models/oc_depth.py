"""Flow of a rigid motion over a scene of known relative inverse depth: nine parameters.

u = a + b rho + c x rho - d y + e x² + f xy + k x
v = g + h rho + c y rho + d x + e xy + f y² + k y

Longuet-Higgins and Prazdny with x, y in any unit: b, h, c are the translation; d, e, f the rotation; a, g its constant
part. k contains a change of focal length and the unknown shift of the inverse depth (c x (rho + shift)), so the model
is exact under both. Signs differ from the printed paper, see ``oc_depth_paper``.

References
----------
H. C. Longuet-Higgins and K. Prazdny, "The interpretation of a moving retinal image", Proc. R. Soc. B 208, 1980.
"""

from moseg.tasks.motion_models.flow_model import FlowModel, terms_matrix

_PARAMETERS = tuple("abcdefghk")

OC_DEPTH = FlowModel(
    name="oc_depth",
    parameters=_PARAMETERS,
    u_terms=terms_matrix(
        _PARAMETERS,
        {"a": (1, "1"), "b": (1, "r"), "c": (1, "xr"), "d": (-1, "y"), "e": (1, "xx"), "f": (1, "xy"), "k": (1, "x")},
    ),
    v_terms=terms_matrix(
        _PARAMETERS,
        {"g": (1, "1"), "h": (1, "r"), "c": (1, "yr"), "d": (1, "x"), "e": (1, "xy"), "f": (1, "yy"), "k": (1, "y")},
    ),
    uses_depth=True,
    has_free_shift=True,
)
