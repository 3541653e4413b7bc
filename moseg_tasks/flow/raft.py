"""Optical flow of batches of frame pairs by RAFT or SEA-RAFT."""

import cv2
import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.raft import RaftParams
from moseg.tasks.networks.raft import STRIDE, Raft
from moseg.tasks.networks.sea_raft import SeaRaft


def estimate_raft_flow(
    model: Raft | SeaRaft, images0: np.ndarray, images1: np.ndarray, params: RaftParams
) -> np.ndarray:
    """Estimate the flow that maps each pixel of the first images to its position in the second.

    Parameters
    ----------
    model : Raft or SeaRaft
        From `build_raft` or `build_sea_raft`, on any device.
    images0, images1 : uint8 (B, y, x, 3)
        RGB frames of one size.
    params : RaftParams or SeaRaftParams
        Those of the model. Frames with a longer side than `max_side` are reduced by averaging areas.

    Returns
    -------
    flow : float32 (B, y, x, 2)
        xy displacement at the frames' own size, px/frame.

    Raises
    ------
    InputError
        The images are not two batches of uint8 RGB frames of one size.

    References
    ----------
    Teed, Deng, "RAFT: Recurrent All-Pairs Field Transforms for Optical Flow", ECCV 2020.
    Wang, Lipson, Deng, "SEA-RAFT: Simple, Efficient, Accurate RAFT for Optical Flow", ECCV 2024.
    """
    for name, images in (("images0", images0), ("images1", images1)):
        if images.dtype != np.uint8 or images.ndim != 4 or images.shape[3] != 3 or images.size == 0:
            got = f"{images.dtype} {images.shape}"
            raise InputError("not a batch of RGB frames", where=name, got=got, expected="uint8 (B, y, x, 3)")
    if images0.shape != images1.shape:
        raise InputError("batches of a pair differ in shape", got=images1.shape, expected=images0.shape)
    size = images0.shape[1:3]
    reduced = _reduced_size(size, params.max_side)
    weights = next(model.parameters())
    with torch.inference_mode():
        batches = [_to_network(images, reduced).to(weights.device, weights.dtype) for images in (images0, images1)]
        left, right, above, below = padding = _padding(reduced, model.min_side)
        batches = [F.pad(batch, padding, mode="replicate") for batch in batches]
        flow = model(*batches, params.iterations, on_demand=params.correlation == "on_demand")
        flow = flow[..., above : flow.shape[2] - below, left : flow.shape[3] - right].float()
        if reduced != size:
            flow = _enlarge(flow, size)
        return np.ascontiguousarray(flow.permute(0, 2, 3, 1).cpu().numpy())


def _reduced_size(size: tuple[int, int], max_side: int) -> tuple[int, int]:
    """Return (y, x) with the longer side at most `max_side`."""
    longest = max(size)
    if longest <= max_side:
        return size
    height, width = (max(round(side * max_side / longest), 1) for side in size)
    return height, width


def _to_network(images: np.ndarray, size: tuple[int, int]) -> Tensor:
    """Convert images to float32 (B, 3, y, x) in [-1, 1], reduced to `size`."""
    values = images.astype(np.float32)
    if images.shape[1:3] != size:
        height, width = size
        values = np.stack([cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA) for image in values])
    return torch.from_numpy(values).permute(0, 3, 1, 2) / 255 * 2 - 1


def _padding(size: tuple[int, int], min_side: int) -> tuple[int, int, int, int]:
    """Return the pixels to add (left, right, above, below), distributed as in the published evaluation on Sintel."""
    height, width = (max(-(-side // STRIDE) * STRIDE, min_side) - side for side in size)
    return width // 2, width - width // 2, height // 2, height - height // 2


def _enlarge(flow: Tensor, size: tuple[int, int]) -> Tensor:
    """Resample flow (B, 2, y, x) to `size` and scale its vectors likewise."""
    (height, width), (reduced_height, reduced_width) = size, flow.shape[2:]
    scale = flow.new_tensor([width / reduced_width, height / reduced_height])
    return F.interpolate(flow, size=size, mode="bilinear", align_corners=False) * scale[:, None, None]
