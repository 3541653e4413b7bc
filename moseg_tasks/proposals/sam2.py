"""Masks of a section's objects, tracked from its first frame by SAM 2.1, EdgeTAM or SAM 3."""

from collections.abc import Iterable, Sequence

import numpy as np
import torch
from torch.nn import functional
from transformers import Sam2VideoInferenceSession, Sam2VideoModel

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.sam2 import Sam2Params
from moseg.schemas.parameters.sam3 import Sam3Params
from moseg.tasks.check_frame import check_frame
from moseg.tasks.networks.frame_tensor import Resizing, frame_tensor
from moseg.tasks.networks.sam2 import forget_past, network_side, start_sessions


def track_masks_sam2(
    model: Sam2VideoModel, frames: Iterable[np.ndarray], seeds: np.ndarray, params: Sam2Params | Sam3Params
) -> np.ndarray:
    """Track the objects of the first frame and return their labels in every frame.

    Each object has its own memory: its mask in the first frame, and its masks and pointers in the last frames. Where
    objects overlap, a pixel gets the label with the highest logit. The memory does not grow with the video.

    Parameters
    ----------
    model : Sam2Video, EdgeTamVideo or Sam3Tracker
    frames : iterable of uint8 (y, x, 3)
        RGB frames of one size, the first being that of `seeds`; read once, one at a time.
    seeds : uint16 (y, x)
        Objects 1, 2, … on the first frame, 0 = background.
    params : Sam2Params or Sam3Params

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
    Ravi et al., "SAM 2: Segment Anything in Images and Videos", ICLR 2025.
    """
    if seeds.dtype != np.uint16 or seeds.ndim != 2 or seeds.size == 0:
        raise InputError("not labels", where="seeds", got=f"{seeds.dtype} {seeds.shape}", expected="uint16 (y, x)")
    sessions = start_sessions(model, seeds, params.objects_per_pass)
    masks = []
    for index, frame in enumerate(frames):
        check_frame(frame, f"frame {index}", seeds.shape)
        labels = _advance(model, sessions, frame, index, params) if sessions else np.zeros_like(seeds)
        masks.append(labels if index else seeds)
    if not masks:
        raise InputError("no frames to track in", where="frames", expected="one or more")
    return np.stack(masks)


@torch.inference_mode()
def _advance(
    model: Sam2VideoModel,
    sessions: Sequence[Sam2VideoInferenceSession],
    frame: np.ndarray,
    index: int,
    params: Sam2Params | Sam3Params,
) -> np.ndarray:
    """Return labels uint16 (y, x) of the next frame, and update the sessions."""
    size, side = frame.shape[:2], network_side(model)
    pixels = frame_tensor(frame, (side, side), model.device, Resizing.PIL_BICUBIC, model.normalisation)
    labels = torch.zeros(size, dtype=torch.int32, device=model.device)
    highest = torch.zeros(size, device=model.device)
    for session in sessions:
        found = model(session, frame=pixels, frame_idx=index)
        for label, small in zip(found.object_ids, found.pred_masks.float(), strict=True):
            logits = functional.interpolate(small[None], size=size, mode="bilinear")[0, 0]
            labels[logits > highest] = label
            highest = torch.maximum(highest, logits)
        # One of the places of the mask memory is the first frame's.
        forget_past(session, index, model.config.num_maskmem - 1, params.memory_reach)
    return labels.cpu().numpy().astype(np.uint16)
