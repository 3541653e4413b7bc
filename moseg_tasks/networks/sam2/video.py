"""SAM 2.1 with its memory: an object's mask carried through a video."""

from transformers import Sam2VideoConfig, Sam2VideoModel

from moseg_tasks.networks.checkpoint import Checkpoint
from moseg_tasks.networks.transformers_model import build_transformers


def build_sam2_video(checkpoint: Checkpoint) -> Sam2VideoModel:
    """The whole network of ``facebook/sam2.1-hiera-*``; no tensor is ignored.

    Raises
    ------
    InputError
        The checkpoint is not one of this network.

    References
    ----------
    Ravi et al., "SAM 2: Segment Anything in Images and Videos", ICLR 2025.
    """
    return build_transformers(Sam2VideoModel, Sam2VideoConfig, checkpoint)
