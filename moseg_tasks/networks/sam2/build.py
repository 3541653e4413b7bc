"""The image network and the video network of SAM 2.1."""

from transformers import Sam2Config, Sam2Model, Sam2VideoConfig, Sam2VideoInferenceSession, Sam2VideoModel

from moseg.tasks.networks.checkpoint import Checkpoint
from moseg.tasks.networks.sam2.first_mask import FirstMaskAsByAuthors
from moseg.tasks.networks.sam2.sessions import to_joinable
from moseg.tasks.networks.transformers_model import build_transformers


def build_sam2_image(checkpoint: Checkpoint) -> Sam2Model:
    """Build image encoder, prompt encoder and mask decoder of ``facebook/sam2.1-hiera-*``.

    The checkpoints are those of the video network. The memory's tensors are ignored by name: ``memory_*``,
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


class Sam2Video(FirstMaskAsByAuthors, Sam2VideoModel):
    """The video network, run as by its authors where the first mask of an object is given."""

    session_class = Sam2VideoInferenceSession

    def _encode_new_memory(self, *args, **kwargs):
        memory, places = super()._encode_new_memory(*args, **kwargs)
        return to_joinable(memory), places


def build_sam2_video(checkpoint: Checkpoint) -> Sam2Video:
    """Build the complete network of ``facebook/sam2.1-hiera-*``; no tensor is ignored.

    Raises
    ------
    InputError
        The checkpoint is not one of this network.

    References
    ----------
    Ravi et al., "SAM 2: Segment Anything in Images and Videos", ICLR 2025.
    """
    return build_transformers(Sam2Video, Sam2VideoConfig, checkpoint)


def network_side(model: Sam2Model | Sam2VideoModel) -> int:
    """Return the side to which frames are resized, whatever their aspect, px: 1024 in the published networks."""
    return model.config.prompt_encoder_config.image_size
