"""Relative inverse depth of a batch of frames, by the network of the parameters."""

import numpy as np
import torch
from transformers import DepthAnythingForDepthEstimation

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.depth_anything import DepthAnythingParams
from moseg.schemas.parameters.depth_anything_3 import DepthAnything3Params
from moseg.schemas.parameters.dpt_dinov2 import DptDinov2Params
from moseg.tasks.depth.depth_anything import predict_depth_anything
from moseg.tasks.depth.depth_anything_3 import predict_depth_anything_3
from moseg.tasks.depth.dpt_dinov2 import predict_dpt_dinov2
from moseg.tasks.networks.depth import DptDinov2
from moseg.tasks.networks.depth_anything_3 import DepthAnything3

_PREDICT = {
    DptDinov2Params: predict_dpt_dinov2,
    DepthAnythingParams: predict_depth_anything,
    DepthAnything3Params: predict_depth_anything_3,
}


def estimate_inverse_depth(
    model: DptDinov2 | DepthAnythingForDepthEstimation | DepthAnything3,
    images: np.ndarray,
    params: DptDinov2Params | DepthAnythingParams | DepthAnything3Params,
) -> np.ndarray:
    """Estimate the relative inverse depth of each frame: larger is nearer.

    DPT-DINOv2 gives metric depth, which is inverted; Depth Anything V2 gives inverse depth up to scale and shift, which
    is returned unchanged: 0 is far away but not at infinity; Depth Anything 3 gives depth up to scale, which is
    inverted. The motion models allow for all three.

    Parameters
    ----------
    model : DptDinov2, DepthAnythingForDepthEstimation or DepthAnything3
        Of `build_dpt_dinov2`, `build_depth_anything` or `build_depth_anything_3`.
    images : uint8 (B, y, x, 3)
        RGB frames of one size.
    params : DptDinov2Params, DepthAnythingParams or DepthAnything3Params
        Those of the model.

    Returns
    -------
    inverse_depth : float32 (B, y, x)
        Finite, not negative.

    Raises
    ------
    InputError
        The images are not uint8 RGB frames, or the network's output is not finite.
    """
    if images.dtype != np.uint8 or images.ndim != 4 or images.shape[3] != 3 or 0 in images.shape[1:3]:
        raise InputError("not RGB frames", got=f"{images.dtype} {images.shape}", expected="uint8 (B, y, x, 3)")
    if len(images) == 0:
        return np.zeros(images.shape[:3], np.float32)
    with torch.inference_mode():
        inverse_depth = _PREDICT[type(params)](model, images, params)
    inverse_depth = inverse_depth.cpu().numpy()
    if not np.isfinite(inverse_depth).all():
        raise InputError("inverse depth is not finite", where=f"the output of {type(model).__name__}")
    return inverse_depth
