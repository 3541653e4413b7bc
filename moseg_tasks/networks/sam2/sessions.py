"""The memory of the objects that SAM 2.1, EdgeTAM and SAM 3 track, kept as small as possible."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
import torch
from transformers import Sam2VideoInferenceSession

if TYPE_CHECKING:
    from moseg.tasks.networks.sam2.build import Sam2Video

# Parts of an output of the network: those that only the frame itself needs, and those that the next few frames need.
_OF_ITS_FRAME = ("pred_masks", "high_res_masks")
_OF_MASK_MEMORY = ("maskmem_features", "maskmem_pos_enc")


def start_sessions(model: "Sam2Video", seeds: np.ndarray, objects_per_session: int) -> list[Sam2VideoInferenceSession]:
    """Create sessions for frame 0, with the seeds as its masks.

    The masks of all objects of a session are encoded in one pass, so their number bounds the memory needed.
    The sessions share the features of the current frame.

    Parameters
    ----------
    model : Sam2Video, EdgeTamVideo or Sam3Tracker
    seeds : uint16 (y, x)
        Objects in the first frame, 0 = background.
    objects_per_session : int
    """
    objects = np.unique(seeds[seeds > 0]).tolist()
    sessions = []
    for some in _parts(objects, objects_per_session):
        session = model.session_class(
            video_height=seeds.shape[0],
            video_width=seeds.shape[1],
            inference_device=model.device,
            inference_state_device=model.device,
            video_storage_device=model.device,
            # Its default is a string, which tensors do not accept.
            dtype=torch.float32,
        )
        for label in some:
            mask = torch.from_numpy(seeds == label).float()[None, None]
            session.add_mask_inputs(session.obj_id_to_idx(label), 0, model.given_mask(mask))
        session.obj_with_new_inputs = list(some)
        sessions.append(session)
        session.cache = sessions[0].cache
    return sessions


def to_joinable(memory: torch.Tensor) -> torch.Tensor:
    """Return the memory of masks in a type that autocast can join with the objects' pointers: it refuses bfloat16."""
    kind = memory.device.type
    return memory.to(torch.get_autocast_dtype(kind)) if torch.is_autocast_enabled(kind) else memory


def forget_past(session: Sam2VideoInferenceSession, index: int, num_masks: int, num_frames: int) -> None:
    """Drop frames and outputs that frames after `index` do not use. By default the session keeps all of them.

    Parameters
    ----------
    session : Sam2VideoInferenceSession
    index : int
        Current frame.
    num_masks, num_frames : int
        Frames before the next one whose masks are kept, and of which anything is kept. The first frame is always kept.
    """
    session.processed_frames.clear()
    for outputs in session.output_dict_per_obj.values():
        first, tracked = outputs["cond_frame_outputs"], outputs["non_cond_frame_outputs"]
        for past in [past for past in tracked if past <= index - num_frames]:
            del tracked[past]
        for output in (*first.values(), *tracked.values()):
            _drop(output, _OF_ITS_FRAME)
        for past in tracked:
            if past <= index - num_masks:
                _drop(tracked[past], _OF_MASK_MEMORY)
    for is_tracked in session.frames_tracked_per_obj.values():
        is_tracked.clear()


def _drop(output: dict, names: tuple[str, ...]) -> None:
    for name in names:
        output.pop(name, None)


def _parts(items: list, length: int) -> Iterator[list]:
    return (items[start : start + length] for start in range(0, len(items), length))
