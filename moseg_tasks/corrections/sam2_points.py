"""Mask of the object at points of a frame, by SAM 2.1."""

import numpy as np
import torch
from torch.nn import functional
from transformers import Sam2Model

from moseg.tasks.check_frame import check_frame
from moseg.tasks.networks.frame_tensor import Resizing, frame_tensor
from moseg.tasks.networks.sam2 import network_side


def segment_points_sam2(model: Sam2Model, image: np.ndarray, points: np.ndarray, not_points: np.ndarray) -> np.ndarray:
    """Segment the object that points prompt: of the decoder's masks for one point the best, for several its single one.

    One point is ambiguous (a part, an object, a group), which is what the three masks stand for.

    Parameters
    ----------
    model : Sam2Model
    image : uint8 (y, x, 3)
        RGB.
    points, not_points : float64 (N, 2)
        xy, px: points on the object, and points that are not.

    Returns
    -------
    bool (y, x)

    Raises
    ------
    InputError
        The image is not an RGB frame.

    References
    ----------
    Ravi et al., "SAM 2: Segment Anything in Images and Videos", ICLR 2025.
    """
    check_frame(image)
    size, side = image.shape[:2], network_side(model)
    prompts = np.concatenate([points, not_points]) * [side / size[1], side / size[0]]
    labels = np.repeat([1, 0], [len(points), len(not_points)])
    with torch.inference_mode():
        pixels = frame_tensor(image, (side, side), model.device, Resizing.TORCH_BILINEAR)
        embeddings = [embedding.float() for embedding in model.get_image_embeddings(pixels)]
        # The decoder is cheap, and encodes positions as sines of large angles: not in half precision.
        with torch.autocast(model.device.type, enabled=False):
            output = model(
                image_embeddings=embeddings,
                input_points=torch.from_numpy(prompts.astype(np.float32)).to(model.device)[None, None],
                input_labels=torch.from_numpy(labels).to(model.device)[None, None],
                multimask_output=len(prompts) == 1,
            )
            best = output.iou_scores[0, 0].argmax()
            logits = functional.interpolate(output.pred_masks[0, 0, best][None, None], size=size, mode="bilinear")
    return (logits[0, 0] > 0).cpu().numpy()
