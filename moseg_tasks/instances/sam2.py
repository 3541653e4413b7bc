"""Masks of the objects that boxes and points show in a frame, by SAM 2.1."""

import numpy as np
import torch
from torch.nn import functional
from transformers import Sam2Model

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.sam2 import Sam2Params
from moseg.tasks.check_frame import check_frame
from moseg.tasks.instances.boxes import as_boxes
from moseg.tasks.networks.frame_tensor import Resizing, frame_tensor
from moseg.tasks.networks.sam2 import network_side


def segment_boxes_sam2(
    model: Sam2Model, image: np.ndarray, boxes: np.ndarray, params: Sam2Params
) -> tuple[np.ndarray, np.ndarray]:
    """Segment one mask for each box: the decoder's single mask, or the best of its three where that is unstable.

    The image is encoded once, resized to the network's square. Under autocast only the encoder runs in half precision:
    the decoder is cheap, and encodes positions as sines of large angles.

    Parameters
    ----------
    model : Sam2Model
    image : uint8 (y, x, 3)
        RGB.
    boxes : floating (n, 4)
        Left, top, right, bottom, px.
    params : Sam2Params

    Returns
    -------
    masks : bool (n, y, x)
    quality : float64 (n,)
        The network's estimate of the IoU of its mask with the true one.

    Raises
    ------
    InputError
        The image is not an RGB frame, or the boxes are not boxes.
    """
    masks, quality = _decode(model, image, as_boxes(boxes), None, 1, params)
    return masks[:, 0], quality[:, 0]


def segment_prompts_sam2(
    model: Sam2Model, image: np.ndarray, boxes: np.ndarray | None, points: np.ndarray | None, params: Sam2Params
) -> tuple[np.ndarray, np.ndarray]:
    """Segment the three masks of each prompt that the decoder proposes: a part, the object, and what it belongs to.

    The image is encoded as by `segment_boxes_sam2`.

    Parameters
    ----------
    model : Sam2Model
    image : uint8 (y, x, 3)
        RGB.
    boxes : floating (n, 4), optional
        Left, top, right, bottom, px.
    points : floating (n, k, 2), optional
        xy of points on each object, px.
    params : Sam2Params

    Returns
    -------
    masks : bool (n, 3, y, x)
    quality : float64 (n, 3)
        The network's estimate of the IoU of each mask with the true one.

    Raises
    ------
    InputError
        The image is not an RGB frame, the boxes are not boxes, the points not points, or there are none of both.
    """
    if boxes is None and points is None:
        raise InputError("no prompts", got="neither boxes nor points", expected="one of them or both")
    if points is not None:
        points = np.asarray(points, np.float32)
        if points.ndim != 3 or points.shape[2] != 2 or not points.shape[1] or not np.isfinite(points).all():
            raise InputError("not points", got=f"shape {points.shape}", expected="(n, k, 2): finite xy, px")
        if boxes is not None and len(boxes) != len(points):
            raise InputError("not one box for the points of each object", got=len(boxes), expected=len(points))
    return _decode(model, image, None if boxes is None else as_boxes(boxes), points, 3, params)


def _decode(
    model: Sam2Model,
    image: np.ndarray,
    boxes: np.ndarray | None,
    points: np.ndarray | None,
    num_masks: int,
    params: Sam2Params,
) -> tuple[np.ndarray, np.ndarray]:
    """Return masks bool (n, num_masks, y, x) of prompts float32 px, and their quality float64 (n, num_masks)."""
    check_frame(image)
    size, side = image.shape[:2], network_side(model)
    num_prompts = len(points if boxes is None else boxes)
    if not num_prompts:
        return np.zeros((0, num_masks, *size), bool), np.zeros((0, num_masks))
    stretch = np.float32([side / size[1], side / size[0]])
    scaled = {}
    if boxes is not None:
        scaled["input_boxes"] = boxes * np.tile(stretch, 2)
    if points is not None:
        scaled["input_points"] = points * stretch
        scaled["input_labels"] = np.ones(points.shape[:2], np.int32)
    masks, quality = [], []
    with torch.inference_mode():
        pixels = frame_tensor(image, (side, side), model.device, Resizing.TORCH_BILINEAR)
        embeddings = model.get_image_embeddings(pixels)
        embeddings = [embedding.float() for embedding in embeddings]
        prompts = {name: torch.from_numpy(values).to(model.device) for name, values in scaled.items()}
        with torch.autocast(model.device.type, enabled=False):
            for start in range(0, num_prompts, params.boxes_per_pass):
                some = {name: values[None, start : start + params.boxes_per_pass] for name, values in prompts.items()}
                output = model(image_embeddings=embeddings, multimask_output=num_masks > 1, **some)
                logits = functional.interpolate(output.pred_masks[0], size=size, mode="bilinear")
                masks.append((logits > 0).cpu().numpy())
                quality.append(output.iou_scores[0].cpu().double().numpy())
    return np.concatenate(masks), np.concatenate(quality)
