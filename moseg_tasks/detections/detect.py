"""Named objects of a frame, by Grounding DINO."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch

from moseg.schemas.parameters.grounding_dino import GroundingDinoParams
from moseg.tasks.check_frame import check_frame
from moseg.tasks.detections.suppression import suppress_boxes
from moseg.tasks.networks.frame_tensor import frame_tensor
from moseg.tasks.networks.grounding_dino import GroundingDino, Prompt, compose_prompts

_MIN_SIDE = 1.0
# Marks between names become blanks.
_NO_MARKS = str.maketrans(",.", "  ")


class Detections(NamedTuple):
    """Boxes of one frame, best score first.

    Attributes
    ----------
    boxes : float32 (n, 4)
        Left, top, right, bottom, px; they may reach beyond the frame.
    scores : float64 (n,)
        Probability of the text's best token.
    tags : tuple of str
        Name of each: the words above the threshold. Empty if there are none.
    """

    boxes: np.ndarray
    scores: np.ndarray
    tags: tuple[str, ...]


def detect_objects(
    detector: GroundingDino, image: np.ndarray, tags: Sequence[str], params: GroundingDinoParams
) -> Detections:
    """Find the named objects.

    As in the authors' code a box is kept if the score of its best token exceeds the box threshold. Its name consists of
    all words that exceed the text threshold, in the order of the text: part of a name, or words of several names. A box
    of which only a full stop or comma exceeds it has no name. Boxes of all prompts compete. Boxes thinner than a pixel
    are dropped, because they cannot prompt a mask.

    The network runs in single precision, also under autocast: it processes one frame of a section, and scores near a
    threshold would change with rounding.

    Parameters
    ----------
    detector : GroundingDino
    image : uint8 (y, x, 3)
        RGB.
    tags : sequence of str
        Names; no boxes are returned if there are none.
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
    max_tokens = model.config.max_text_len
    prompts = compose_prompts(detector.tokenizer, tags, params.tags_per_prompt, max_tokens, params.separator)
    if not prompts:
        return Detections(np.zeros((0, 4), np.float32), np.zeros(0), ())
    pixels = frame_tensor(image, detector.input_size(height, width, params.input_scale), model.device)
    with torch.inference_mode(), torch.autocast(model.device.type, enabled=False):
        found = [_run_prompt(detector, pixels, prompt, params) for prompt in prompts]
    boxes = np.concatenate([part.boxes for part in found]) * [width, height, width, height]
    scores = np.concatenate([part.scores for part in found])
    names = np.array([name for part in found for name in part.tags], dtype=np.str_)
    is_visible = (boxes[:, 2:] - boxes[:, :2] >= _MIN_SIDE).all(axis=1)
    boxes, scores, names = boxes[is_visible], scores[is_visible], names[is_visible]
    groups = np.unique(names, return_inverse=True)[1] if params.nms_per_tag else None
    kept = suppress_boxes(boxes, scores, params.nms_iou, groups)[: params.max_boxes]
    return Detections(boxes[kept].astype(np.float32), scores[kept], tuple(names[kept].tolist()))


def _run_prompt(
    detector: GroundingDino, pixels: torch.Tensor, prompt: Prompt, params: GroundingDinoParams
) -> Detections:
    """Return the boxes above the box threshold; corners relative to the frame's sides, float64."""
    token_ids = torch.tensor([prompt.token_ids], device=detector.model.device)
    output = detector.model(pixel_values=pixels, input_ids=token_ids, attention_mask=torch.ones_like(token_ids))
    # Doubled on the CPU: not every device has float64.
    fits = output.logits[0].cpu().double().sigmoid().numpy()[:, : len(prompt.token_ids)]
    scores = fits.max(axis=1)
    is_found = scores > params.box_threshold
    names = tuple(_name(detector, prompt, fit > params.text_threshold) for fit in fits[is_found])
    centre, size = np.split(output.pred_boxes[0].cpu().double().numpy()[is_found], 2, axis=1)
    return Detections(np.concatenate([centre - size / 2, centre + size / 2], axis=1), scores[is_found], names)


def _name(detector: GroundingDino, prompt: Prompt, is_named: np.ndarray) -> str:
    """Return the tokens that name a box, without those that begin, end or separate the text."""
    ids = [token for token, named in zip(prompt.token_ids[1:-1], is_named[1:-1], strict=True) if named]
    return " ".join(detector.tokenizer.decode(ids).translate(_NO_MARKS).split())
