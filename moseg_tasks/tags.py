"""The tags of a frame."""

from typing import NamedTuple

import numpy as np
import torch
from scipy.special import expit

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.ram import RamParams
from moseg.tasks.networks.frame_tensor import frame_tensor
from moseg.tasks.networks.ram import Tagger


class Tags(NamedTuple):
    """Tags of a frame.

    Attributes
    ----------
    names : tuple of str
        In the order of the tagger's list, in which the authors' code gives them to the detector.
    scores : float64 (n,)
        Probability of each.
    """

    names: tuple[str, ...]
    scores: np.ndarray


def recognise_tags(tagger: Tagger, image: np.ndarray, params: RamParams) -> Tags:
    """Return the tags whose probability exceeds their own threshold.

    Parameters
    ----------
    tagger : Tagger
        RAM or RAM++.
    image : uint8 (y, x, 3)
        RGB; resized to the network's square, as in its training.
    params : RamParams

    Returns
    -------
    Tags
        Empty if no tag exceeds its threshold.

    Raises
    ------
    InputError
        The image is not an RGB frame, or a tag to leave out is not one of the tagger's.

    References
    ----------
    Zhang et al., "Recognize Anything: A Strong Image Tagging Model", 2023.
    """
    unknown = [name for name in params.excluded_tags if name not in tagger.names]
    if unknown:
        raise InputError("not a tag of the tagger's list", where="ram.excluded_tags", got=", ".join(unknown))
    network = tagger.network
    side = network.config.image.image_size
    with torch.inference_mode():
        logits = network(frame_tensor(image, (side, side), next(network.parameters()).device))[0]
    scores = expit(logits.cpu().numpy().astype(np.float64))
    is_wanted = np.array([name not in params.excluded_tags for name in tagger.names])
    found = np.flatnonzero(is_wanted & (scores > params.threshold_scale * tagger.thresholds))
    kept = np.sort(found[np.argsort(-scores[found], kind="stable")][: params.max_tags])
    return Tags(tuple(tagger.names[index] for index in kept), scores[kept])
