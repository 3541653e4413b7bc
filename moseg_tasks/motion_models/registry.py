"""Flow models by name."""

from moseg.schemas.errors import InputError
from moseg.tasks.motion_models.flow_model import FlowModel
from moseg.tasks.motion_models.oc import OC
from moseg.tasks.motion_models.oc_depth import OC_DEPTH
from moseg.tasks.motion_models.oc_depth_paper import OC_DEPTH_PAPER

FLOW_MODELS: dict[str, FlowModel] = {model.name: model for model in (OC_DEPTH, OC_DEPTH_PAPER, OC)}


def flow_model(name: str) -> FlowModel:
    """The flow model of this name; raises InputError where there is none."""
    if name not in FLOW_MODELS:
        raise InputError("unknown flow model", got=name, expected=", ".join(FLOW_MODELS))
    return FLOW_MODELS[name]
