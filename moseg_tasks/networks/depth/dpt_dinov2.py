"""DINOv2 with a dense-prediction-transformer head: metric depth of a single image."""

from transformers import DPTConfig, DPTForDepthEstimation

from moseg_tasks.networks.checkpoint import Checkpoint
from moseg_tasks.networks.depth.positions import resample_as_trained
from moseg_tasks.networks.transformers_model import CONFIG, build_transformers, read_json
from schemas.errors import InputError


def build_dpt_dinov2(checkpoint: Checkpoint) -> DPTForDepthEstimation:
    """The network of ``facebook/dpt-dinov2-{small,base,large,giant}-{nyu,kitti}``.

    Of the checkpoint's documents only ``config.json`` is read. What ``preprocessor_config.json`` would say is the same
    for all eight and fixed in ``moseg_tasks.depth``: no resizing, ImageNet's mean and deviation, zeros around the frame
    up to multiples of 14.

    Raises
    ------
    InputError
        The checkpoint is not one of this network; another backbone under the same head would give inverse depth.

    References
    ----------
    Oquab et al., "DINOv2: Learning Robust Visual Features without Supervision", TMLR 2024.
    Ranftl, Bochkovskiy, Koltun, "Vision Transformers for Dense Prediction", ICCV 2021.
    """
    backbone = (read_json(checkpoint, CONFIG).get("backbone_config") or {}).get("model_type")
    if backbone != "dinov2":
        where = f"{CONFIG} of weights {checkpoint.name}"
        raise InputError("another backbone", where=where, got=backbone, expected="dinov2")
    return resample_as_trained(build_transformers(DPTForDepthEstimation, DPTConfig, checkpoint))
