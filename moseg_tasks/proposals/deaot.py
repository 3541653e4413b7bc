"""Masks of a section's objects, tracked from its first frame by DeAOT."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import cv2
import numpy as np
import torch
from torch.nn import functional as F

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.deaot import DeaotParams
from moseg.tasks.check_frame import check_frame
from moseg.tasks.networks.deaot import STRIDE, Deaot, extend_memory
from moseg.tasks.networks.frame_tensor import IMAGENET_MEAN, IMAGENET_STD

# Distance of probabilities from 0 and 1 where groups are merged, as in the authors' engine.
_MARGIN = 1e-5


class Propagated(NamedTuple):
    """One frame's masks.

    Attributes
    ----------
    labels : uint16 (y, x)
        0 = background.
    logits : torch.Tensor of float32 (1 + object, y, x) or None
        Of the background and each object; None in the first frame, whose labels were given.
    """

    labels: np.ndarray
    logits: torch.Tensor | None


def track_masks_deaot(model: Deaot, frames: Iterable[np.ndarray], seeds: np.ndarray, params: DeaotParams) -> np.ndarray:
    """Track the objects of the first frame and return their labels in every frame.

    More objects than one pass of the network holds are tracked in groups, whose logits are merged as in the authors'
    engine. Unlike there, long-term memory is bounded, see `DeaotParams.memory_frames`.

    Parameters
    ----------
    model : Deaot
    frames : iterable of uint8 (y, x, 3)
        RGB frames of one size, the first being that of `seeds`.
    seeds : uint16 (y, x)
        Objects 1, 2, … on the first frame, 0 = background.
    params : DeaotParams

    Returns
    -------
    masks : uint16 (frame, y, x)
        `seeds`, then the predicted labels. All 0 where there are no seeds.

    Raises
    ------
    InputError
        The seeds are not labels, there are no frames, or a frame is not RGB of the seeds' size.

    References
    ----------
    Yang and Yang, "Decoupling Features in Hierarchical Propagation for Video Object Segmentation", NeurIPS 2022.
    """
    masks = [frame.labels for frame in propagate_masks(model, frames, seeds, params)]
    if not masks:
        raise InputError("no frames to track in", where="frames", expected="one or more")
    return np.stack(masks)


@torch.inference_mode()
def propagate_masks(
    model: Deaot, frames: Iterable[np.ndarray], seeds: np.ndarray, params: DeaotParams
) -> Iterator[Propagated]:
    """Yield frame by frame what `track_masks_deaot` returns, with its logits; raises the same errors."""
    if seeds.dtype != np.uint16 or seeds.ndim != 2 or seeds.size == 0:
        raise InputError("not labels", where="seeds", got=f"{seeds.dtype} {seeds.shape}", expected="uint16 (y, x)")
    num_objects = int(seeds.max())
    shown = network_size(seeds.shape, params.max_side)
    grid, weight = model.grid(shown), next(model.parameters())
    for index, frame in enumerate(frames):
        check_frame(frame, f"frame {index}", seeds.shape)
        if num_objects == 0:
            yield Propagated(np.zeros_like(seeds), None)
            continue
        image = torch.from_numpy(_normalised(frame, shown)).to(weight)
        encoded = model.encode(image.permute(2, 0, 1)[None])
        if index == 0:
            labels = torch.from_numpy(seeds.astype(np.float32)).to(weight.device)
            short_term = long_term = model.memorize(encoded, _group_masks(labels, num_objects, shown, model), grid)
            yield Propagated(seeds, None)
            continue
        logits, projected = model.propagate(encoded, long_term, short_term, grid)
        logits = F.interpolate(logits, size=seeds.shape, mode="bilinear", align_corners=True)
        logits = _merged(logits, num_objects)
        labels = logits.argmax(dim=0)
        short_term = model.remember(projected, _group_masks(labels.float(), num_objects, shown, model))
        if index % params.memory_every == 0:
            pairs = zip(long_term, short_term, strict=True)
            long_term = [extend_memory(memory, newest, params.memory_frames) for memory, newest in pairs]
        yield Propagated(labels.cpu().numpy().astype(np.uint16), logits)


def network_size(size: tuple[int, int], max_side: int) -> tuple[int, int]:
    """Return the size (y, x) of the network's input for frames of `size`: sides of 1 modulo 16.

    A frame with a side over `max_side` is reduced; then sides are rounded to the nearest such number, at least 17.
    """
    scale = min(1.0, max_side / max(size))
    height, width = (max(round((int(scale * side) - 1) / STRIDE), 1) * STRIDE + 1 for side in size)
    return height, width


def _normalised(frame: np.ndarray, shown: tuple[int, int]) -> np.ndarray:
    """Return the encoder's input, float32 (y, x, 3); resized with the authors' interpolation."""
    image = frame.astype(np.float32)
    if frame.shape[:2] != shown:
        image = cv2.resize(image, shown[::-1], interpolation=cv2.INTER_CUBIC)
    image /= 255
    image -= IMAGENET_MEAN
    image /= IMAGENET_STD
    return image


def _group_masks(labels: torch.Tensor, num_objects: int, shown: tuple[int, int], model: Deaot) -> torch.Tensor:
    """Return masks (group, 1 + max_objects, y, x) at network size: all outside the group, then each of its objects."""
    max_objects = model.config.max_objects
    num_groups = -(-num_objects // max_objects)
    labels = F.interpolate(labels[None, None], size=shown, mode="nearest")[0, 0]
    objects = torch.arange(1, num_groups * max_objects + 1, device=labels.device).view(num_groups, max_objects, 1, 1)
    object_masks = labels == objects
    masks = torch.cat([~object_masks.any(dim=1, keepdim=True), object_masks], dim=1)
    return masks.to(next(model.parameters()).dtype)


def _merged(logits: torch.Tensor, num_objects: int) -> torch.Tensor:
    """Return logits (1 + num_objects, y, x) of all groups (group, 1 + max_objects, y, x), without unused identities.

    A pixel is background if it is background in every group.
    """
    max_objects = logits.shape[1] - 1
    parts = [part[: 1 + num_objects - i * max_objects] for i, part in enumerate(logits)]
    if len(parts) == 1:
        return parts[0]
    parts = [part.softmax(dim=0) for part in parts]
    background = torch.stack([part[0] for part in parts]).prod(dim=0, keepdim=True)
    return torch.cat([background, *(part[1:] for part in parts)]).clamp(_MARGIN, 1 - _MARGIN).logit()
