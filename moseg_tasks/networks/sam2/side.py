"""The square that SAM 2.1 sees of a frame."""

from transformers import Sam2Model, Sam2VideoModel


def network_side(model: Sam2Model | Sam2VideoModel) -> int:
    """Side to which frames are stretched, whatever their aspect, px: 1024 in the published networks."""
    return model.config.prompt_encoder_config.image_size
