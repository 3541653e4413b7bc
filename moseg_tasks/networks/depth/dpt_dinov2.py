"""DINOv2 with a dense-prediction-transformer head: metric depth of a single image."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import torch
from transformers import DPTConfig, DPTForDepthEstimation

from moseg.schemas.errors import InputError
from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.depth.positions import resample_as_trained
from moseg.tasks.networks.transformers_model import CONFIG, build_transformers, read_json


class DptDinov2(NamedTuple):
    """A network of metric depth with the depths that it was trained for.

    Attributes
    ----------
    model : DPTForDepthEstimation
    min_depth : float
        Offset that the authors' head adds to its output, m; `model` does not.
    max_depth : float
        Limit to which the authors clamp the output, m; infinity if the user's weights do not give it.
    """

    model: DPTForDepthEstimation
    min_depth: float = 0.0
    max_depth: float = float("inf")

    def to(self, device: torch.device | str) -> "DptDinov2":
        """Return a copy with its network on another device."""
        return self._replace(model=self.model.to(device))


def build_dpt_dinov2(checkpoint: Checkpoint) -> DptDinov2:
    """Build the network of ``facebook/dpt-dinov2-{small,base,large,giant}-{nyu,kitti}``.

    Of the checkpoint's documents only ``config.json`` is read. The content of ``preprocessor_config.json`` is the same
    for all eight and fixed in ``moseg.tasks.depth``: no resizing, ImageNet's mean and deviation, zeros around the frame
    up to multiples of 14. The range of depths, which differs, is the ``min_depth`` and ``max_depth`` of the
    checkpoint's own config: 0.001 m to 10 m on NYU, to 80 m on KITTI, as in the authors' ``dinov2/hub/depthers.py``.

    Raises
    ------
    InputError
        The checkpoint is not one of this network (another backbone under the same head gives inverse depth), or its
        range of depths is invalid.

    References
    ----------
    Oquab et al., "DINOv2: Learning Robust Visual Features without Supervision", TMLR 2024.
    Ranftl, Bochkovskiy, Koltun, "Vision Transformers for Dense Prediction", ICCV 2021.
    """
    backbone = (read_json(checkpoint, CONFIG).get("backbone_config") or {}).get("model_type")
    if backbone != "dinov2":
        where = f"{CONFIG} of weights {checkpoint.name}"
        raise InputError("another backbone", where=where, got=backbone, expected="dinov2")
    depth_range = _read_range(checkpoint.config, checkpoint.name)
    return DptDinov2(
        resample_as_trained(build_transformers(DPTForDepthEstimation, DPTConfig, checkpoint)), *depth_range
    )


def _read_range(config: Mapping[str, Any], name: str) -> tuple[float, float]:
    """Return minimal and maximal depth, m."""
    known = DptDinov2._field_defaults
    depths = [config.get(key, known[key]) for key in known]
    is_range = all(isinstance(depth, int | float) for depth in depths) and 0 <= depths[0] < depths[1]
    if not is_range or config.keys() - known:
        expected = "min_depth and max_depth, m, the first at least 0 and below the second"
        raise InputError("no range of depths", where=f"config of weights {name}", got=dict(config), expected=expected)
    return float(depths[0]), float(depths[1])
