"""Masks of the objects in the boxes of a frame, by SAM 2.1."""

import numpy as np
import torch
from torch.nn import functional
from transformers import Sam2Model

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
    check_frame(image)
    boxes = as_boxes(boxes)
    size, side = image.shape[:2], network_side(model)
    if not len(boxes):
        return np.zeros((0, *size), bool), np.zeros(0)
    masks, quality = [], []
    with torch.inference_mode():
        pixels = frame_tensor(image, (side, side), model.device, Resizing.TORCH_BILINEAR)
        embeddings = model.get_image_embeddings(pixels)
        embeddings = [embedding.float() for embedding in embeddings]
        prompts = torch.from_numpy(boxes * np.float32([side / size[1], side / size[0]] * 2)).to(model.device)
        with torch.autocast(model.device.type, enabled=False):
            for some in prompts.split(params.boxes_per_pass):
                output = model(image_embeddings=embeddings, input_boxes=some[None], multimask_output=False)
                logits = functional.interpolate(output.pred_masks[0], size=size, mode="bilinear")
                masks.append((logits[:, 0] > 0).cpu().numpy())
                quality.append(output.iou_scores[0, :, 0].cpu().double().numpy())
    return np.concatenate(masks), np.concatenate(quality)
