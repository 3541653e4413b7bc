"""The modules of SAM-HQ with their weights."""

from transformers import SamHQConfig, SamHQModel

from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.transformers_model import build_transformers


def build_sam_hq(checkpoint: Checkpoint) -> SamHQModel:
    """The network of ``syscv-community/sam-hq-vit-base``, ``-large`` and ``-huge``.

    It is run by `encode_image` and `decode_boxes`, not by its own ``forward``.

    Raises
    ------
    InputError
        The checkpoint is not one of this network.

    References
    ----------
    Ke et al., "Segment Anything in High Quality", NeurIPS 2023.
    """
    return build_transformers(SamHQModel, SamHQConfig, checkpoint)
