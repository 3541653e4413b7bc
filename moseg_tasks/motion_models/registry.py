"""Flow models by name."""

from moseg.tasks.motion_models.flow_model import FlowModel
from moseg.tasks.motion_models.oc import OC
from moseg.tasks.motion_models.oc_depth import OC_DEPTH
from moseg.tasks.motion_models.oc_depth_paper import OC_DEPTH_PAPER

FLOW_MODELS: dict[str, FlowModel] = {model.name: model for model in (OC_DEPTH, OC_DEPTH_PAPER, OC)}
