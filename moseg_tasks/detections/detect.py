"""Named objects of a frame, by Grounding DINO."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch

from moseg_tasks.detections.suppression import suppress_boxes
from moseg_tasks.networks.frame_tensor import check_frame, frame_tensor
from moseg_tasks.networks.grounding_dino import GroundingDino, Prompt, compose_prompts
from schemas.parameters.grounding_dino import GroundingDinoParams

_LEAST_SIDE = 1.0


class Detections(NamedTuple):
    """Boxes of one frame, best score first.

    Attributes
    ----------
    boxes : float32 (n, 4)
        Left, top, right, bottom within the frame, px.
    scores : float64 (n,)
        Probability of the best matching word of the box's name.
    tags : tuple of str
        Name of each.
    """

    boxes: np.ndarray
    scores: np.ndarray
    tags: tuple[str, ...]


def detect_objects(
    detector: GroundingDino, image: np.ndarray, tags: Sequence[str], params: GroundingDinoParams
) -> Detections:
    """Find what the names name.

    A box belongs to the name whose words fit it best on average; the box's score is that of its best word, which is
    what the published box threshold is applied to. The official code strings together whatever words exceed the text
    threshold instead, across the names; here that threshold says which names a box may have. Boxes of all prompts
    compete.

    The whole network works in single precision, under autocast too: it sees one frame of a section, and thresholds
    would change with rounding.

    Parameters
    ----------
    detector : GroundingDino
    image : uint8 (y, x, 3)
        RGB.
    tags : sequence of str
        Names; without any there are no boxes.
    params : GroundingDinoParams

    Returns
    -------
    Detections

    Raises
    ------
    InputError
        The image is not an RGB frame, or a name has no word.
    """
    check_frame(image)
    height, width = image.shape[:2]
    model = detector.model
    prompts = compose_prompts(detector.tokenizer, tags, params.tags_per_prompt, model.config.max_text_len)
    if not prompts:
        return Detections(np.zeros((0, 4), np.float32), np.zeros(0), ())
    pixels = frame_tensor(image, detector.input_size(height, width, params.input_scale), model.device)
    with torch.inference_mode(), torch.autocast(model.device.type, enabled=False):
        found = [_run_prompt(model, pixels, prompt, params) for prompt in prompts]
    names = np.array([name for prompt in prompts for name in prompt.tags])
    firsts = np.cumsum([0, *(len(prompt.tags) for prompt in prompts)])
    relative, scores = (np.concatenate([part[column] for part in found]) for column in (0, 1))
    tag = np.concatenate([part[2] + first for part, first in zip(found, firsts, strict=False)])
    boxes = np.clip(relative, 0, 1) * [width, height, width, height]
    is_visible = (boxes[:, 2:] - boxes[:, :2] >= _LEAST_SIDE).all(axis=1)
    boxes, scores, tag = boxes[is_visible], scores[is_visible], tag[is_visible]
    kept = suppress_boxes(boxes, scores, params.nms_iou, tag if params.nms_per_tag else None)[: params.max_boxes]
    return Detections(boxes[kept].astype(np.float32), scores[kept], tuple(names[tag[kept]].tolist()))


def _run_prompt(
    model: torch.nn.Module, pixels: torch.Tensor, prompt: Prompt, params: GroundingDinoParams
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What passes the thresholds: corners as shares of the frame's sides, scores, indices into the prompt's names."""
    token_ids = torch.tensor([prompt.token_ids], device=model.device)
    output = model(pixel_values=pixels, input_ids=token_ids, attention_mask=torch.ones_like(token_ids))
    # Doubled on the CPU: not every device has float64.
    words = output.logits[0].cpu().double().sigmoid().numpy()
    fits = np.stack([words[:, span].mean(axis=1) for span in prompt.spans], axis=1)
    tag = fits.argmax(axis=1)
    rows = np.arange(len(tag))
    scores = np.stack([words[:, span].max(axis=1) for span in prompt.spans], axis=1)[rows, tag]
    is_found = (scores > params.box_threshold) & (fits[rows, tag] > params.text_threshold)
    centre, size = np.split(output.pred_boxes[0].cpu().double().numpy()[is_found], 2, axis=1)
    return np.concatenate([centre - size / 2, centre + size / 2], axis=1), scores[is_found], tag[is_found]
