"""Names of motion models in recipes, with the fingerprint of the code for a model of a plug-in."""

from collections.abc import Mapping
from typing import Any

from moseg.schemas.errors import InputError

_codes: dict[tuple[str, str], str] = {}


def set_model_code(kind: str, name: str, code: str) -> None:
    """Set the fingerprint of the plug-in that a motion model comes from; `kind` is ``flow`` or ``point``."""
    _codes[kind, name] = code


def model_params(kind: str, name: str) -> dict[str, str]:
    """Return the parameters of a recipe that identify a motion model; `kind` is ``flow`` or ``point``."""
    code = _codes.get((kind, name))
    return {"model": name} if code is None else {"model": name, "model_code": code}


def flow_model_of(params: Mapping[str, Any]):
    """Return the flow model that a recipe names; raises InputError if the plug-in's code is not the recipe's."""
    from moseg.tasks.motion_models import FLOW_MODELS

    return _find("flow", params, FLOW_MODELS)


def point_model_of(params: Mapping[str, Any]):
    """Return the point model that a recipe names; raises InputError if the plug-in's code is not the recipe's."""
    from moseg.tasks.point_models import POINT_MODELS

    return _find("point", params, POINT_MODELS)


def _find(kind: str, params: Mapping[str, Any], models: Mapping[str, Any]):
    name, wanted = params["model"], params.get("model_code")
    if name not in models or _codes.get((kind, name)) != wanted:
        got = f"code {_codes.get((kind, name))}" if name in models else "no such model"
        where = f"{kind} model {name}"
        raise InputError("another version of a plug-in, or none", where=where, got=got, expected=f"code {wanted}")
    return models[name]
