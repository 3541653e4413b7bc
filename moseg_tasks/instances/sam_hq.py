"""Masks of the objects in the boxes of a frame, by SAM-HQ."""

import numpy as np
import torch
from torch.nn import functional

from moseg.schemas.parameters.sam_hq import SamHqParams
from moseg.tasks.check_frame import check_frame
from moseg.tasks.instances.boxes import as_boxes
from moseg.tasks.networks.frame_tensor import frame_tensor
from moseg.tasks.networks.sam_hq import decode_boxes, encode_image


def segment_boxes_sam_hq(
    model: torch.nn.Module, image: np.ndarray, boxes: np.ndarray, params: SamHqParams
) -> tuple[np.ndarray, np.ndarray]:
    """Segment one mask for each box.

    The image is encoded once, resized until its longer side fills the network's square (1024 px in the published
    ones) and padded below and to the right.

    Parameters
    ----------
    model : torch.nn.Module
        Of `build_sam_hq`.
    image : uint8 (y, x, 3)
        RGB.
    boxes : floating (n, 4)
        Left, top, right, bottom, px.
    params : SamHqParams

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
    size = image.shape[:2]
    if not len(boxes):
        return np.zeros((0, *size), bool), np.zeros(0)
    side = model.config.vision_config.image_size
    scale = side / max(size)
    seen = tuple(int(length * scale + 0.5) for length in size)
    masks, quality = [], []
    stretch = np.tile([seen[1] / size[1], seen[0] / size[0]], 2)
    prompts = torch.from_numpy((boxes * stretch).astype(np.float32)).to(model.device)
    with torch.inference_mode():
        pixels = frame_tensor(image, seen, model.device)
        features = encode_image(model, functional.pad(pixels, (0, side - seen[1], 0, side - seen[0])))
        for some in prompts.split(params.boxes_per_pass):
            logits, expected = decode_boxes(model, features, some, params.hq_token_only)
            logits = functional.interpolate(logits[:, None], size=(side, side), mode="bilinear")
            logits = functional.interpolate(logits[..., : seen[0], : seen[1]], size=size, mode="bilinear")
            masks.append((logits[:, 0] > 0).cpu().numpy())
            quality.append(expected.cpu().double().numpy())
    return np.concatenate(masks), np.concatenate(quality)
