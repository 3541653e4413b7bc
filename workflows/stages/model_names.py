"""How motion models stand in recipes: by name, and a plug-in's model also by the fingerprint of its code."""


def flow_model_params(name: str) -> dict[str, str]:
    """Return what a recipe says of a flow model."""
    from moseg.tasks.motion_models import FLOW_MODELS

    return _model_params(name, FLOW_MODELS[name])


def point_model_params(name: str) -> dict[str, str]:
    """Return what a recipe says of a point model."""
    from moseg.tasks.point_models import POINT_MODELS

    return _model_params(name, POINT_MODELS[name])


def _model_params(name: str, model: object) -> dict[str, str]:
    from moseg.workflows.stages.plugin_code import plugin_fingerprint

    code = plugin_fingerprint(model)
    return {"model": name} if code is None else {"model": name, "model_code": code}
