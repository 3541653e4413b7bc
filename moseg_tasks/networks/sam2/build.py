"""The image network and the video network of SAM 2.1."""

from torch.nn import functional
from transformers import Sam2Config, Sam2Model, Sam2VideoConfig, Sam2VideoModel

from moseg.tasks.networks.checkpoint import Checkpoint
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


class Sam2Video(Sam2VideoModel):
    """The video network, run as by its authors where the first mask of an object is given.

    transformers 5.23 then takes the object's pointer from the best of three masks and stores the given mask unchanged
    in memory. The authors take the pointer from the single mask, and store the given mask resampled from a quarter of
    its size.
    """

    def _single_frame_forward(self, *args, **kwargs):
        if kwargs.get("input_masks") is not None:
            kwargs.setdefault("multimask_output", False)
        return super()._single_frame_forward(*args, **kwargs)

    def _use_mask_as_output(self, *args, **kwargs):
        found = super()._use_mask_as_output(*args, **kwargs)
        side = (self.image_size, self.image_size)
        found.high_res_masks = functional.interpolate(found.pred_masks, size=side, mode="bilinear")
        return found


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
