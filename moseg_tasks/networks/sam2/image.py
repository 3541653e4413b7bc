"""The part of SAM 2.1 that outlines what is prompted on one image."""

from transformers import Sam2Config, Sam2Model

from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.transformers_model import build_transformers


def build_sam2_image(checkpoint: Checkpoint) -> Sam2Model:
    """Image encoder, prompt encoder and mask decoder of ``facebook/sam2.1-hiera-*``.

    The checkpoints are those of the video network. What only the memory needs is ignored by name: ``memory_*``,
    ``mask_downsample``, ``object_pointer_proj``, ``no_object_pointer``, ``no_memory_positional_encoding``,
    ``temporal_positional_encoding_projection_layer`` and ``occlusion_spatial_embedding_parameter``.

    Raises
    ------
    InputError
        The checkpoint is not one of this network.

    References
    ----------
    Ravi et al., "SAM 2: Segment Anything in Images and Videos", ICLR 2025.
    """
    return build_transformers(Sam2Model, Sam2Config, checkpoint)
