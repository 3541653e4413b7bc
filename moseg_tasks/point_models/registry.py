"""Point models by name."""

from moseg.schemas.errors import InputError
from moseg.tasks.motion_models import FLOW_MODELS
from moseg.tasks.point_models.affine import AffineModel
from moseg.tasks.point_models.flow import FlowPointModel
from moseg.tasks.point_models.fundamental import FundamentalModel
from moseg.tasks.point_models.homography import HomographyModel
from moseg.tasks.point_models.point_model import PointModel
from moseg.tasks.point_models.trifocal import TrifocalModel

POINT_MODELS: dict[str, PointModel] = {
    model.name: model
    for model in (
        AffineModel(),
        HomographyModel(),
        FundamentalModel(),
        FundamentalModel(rank_two=False, name="bilinear"),
        TrifocalModel(),
        FlowPointModel(FLOW_MODELS["oc"]),
        FlowPointModel(FLOW_MODELS["oc_depth"]),
    )
}


def point_model(name: str) -> PointModel:
    """Return the point model of this name; raise InputError if there is none."""
    if name not in POINT_MODELS:
        raise InputError("unknown point model", got=name, expected=", ".join(POINT_MODELS))
    return POINT_MODELS[name]
