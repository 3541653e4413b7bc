"""Objects of a frame that phrases name, found and outlined by SAM 3."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch.nn import functional

from moseg.schemas.parameters.sam3 import Sam3Params
from moseg.tasks.check_frame import check_frame
from moseg.tasks.networks.frame_tensor import SYMMETRIC, frame_tensor
from moseg.tasks.networks.sam3 import Sam3Detector


class NamedMasks(NamedTuple):
    """Objects of one frame, in the order of the names.

    Attributes
    ----------
    masks : bool (n, y, x)
        They may overlap, and show one object twice if two names mean it.
    scores : float64 (n,)
        Probability that each is the named thing.
    tags : tuple of str
        The name of each.
    """

    masks: np.ndarray
    scores: np.ndarray
    tags: tuple[str, ...]


def segment_concepts(detector: Sam3Detector, image: np.ndarray, names: Sequence[str], params: Sam3Params) -> NamedMasks:
    """Find and outline every object that one of the names means.

    The frame is encoded once, resized to the network's square, and decoded for each name alone, so that what is found
    by a name does not depend on the others. A score is the probability that the name means anything in the frame, times
    that it means this object. As in the authors' code, a mask is the pixels whose logits exceed 0 at the frame's size.

    The network runs in single precision, also under autocast: it processes one frame of a section, and scores near the
    threshold would change with rounding.

    Parameters
    ----------
    detector : Sam3Detector
    image : uint8 (y, x, 3)
        RGB.
    names : sequence of str
        Nouns or short phrases; letter case and repeated names make no difference.
    params : Sam3Params

    Returns
    -------
    NamedMasks

    Raises
    ------
    InputError
        The image is not an RGB frame, or a name has no word or too many.

    References
    ----------
    Carion et al., "SAM 3: Segment Anything with Concepts", arXiv 2511.16719, 2025.
    """
    check_frame(image)
    model = detector.model
    masks, scores, tags = [np.zeros((0, *image.shape[:2]), bool)], [np.zeros(0)], []
    with torch.inference_mode(), torch.autocast(model.device.type, enabled=False):
        pixels = frame_tensor(image, (detector.side, detector.side), model.device, normalisation=SYMMETRIC)
        vision = model.get_vision_features(pixels)
        for name in dict.fromkeys(" ".join(name.lower().split()) for name in names):
            found = detector.find(vision, name)
            # Doubled on the CPU: not every device has float64.
            is_any, is_this = (
                logits[0].cpu().double().sigmoid() for logits in (found.presence_logits, found.pred_logits)
            )
            probability = (is_any * is_this).numpy()
            chosen = np.flatnonzero(probability > params.min_score)
            masks += _enlarge(found.pred_masks[0], chosen, image.shape[:2], params.objects_per_pass)
            scores.append(probability[chosen])
            tags += [name] * len(chosen)
    return NamedMasks(np.concatenate(masks), np.concatenate(scores), tuple(tags))


def _enlarge(logits: torch.Tensor, chosen: np.ndarray, size: tuple[int, int], per_pass: int) -> list[np.ndarray]:
    """Return masks bool (k, y, x) at the frame's size of the chosen logits (query, y, x), in parts."""
    masks = []
    for start in range(0, len(chosen), per_pass):
        some = logits[chosen[start : start + per_pass]][None]
        masks.append((functional.interpolate(some, size=size, mode="bilinear")[0] > 0).cpu().numpy())
    return masks
