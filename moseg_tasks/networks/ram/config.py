"""Sizes of RAM and RAM++."""

from pydantic import Field, model_validator

from moseg.schemas.frozen import Frozen
from moseg.tasks.networks.swin import SwinConfig


class RamConfig(Frozen):
    """Sizes of the tagger; the defaults are those of the published checkpoints with a Swin-L at 384 px."""

    image: SwinConfig = Field(default_factory=SwinConfig, description="the image encoder")
    num_tags: int = Field(4585, ge=1, description="tags of the list")
    num_descriptions: int = Field(51, ge=1, description="text embeddings of each tag in RAM++; RAM has one")
    embedding_width: int = Field(512, ge=1, description="channels of CLIP's text embeddings")
    width: int = Field(768, ge=1, description="channels of the tagging head")
    num_heads: int = Field(4, ge=1, description="attention heads of the tagging head")
    hidden: int = Field(3072, ge=1, description="hidden channels of the tagging head's perceptrons")
    num_layers: int = Field(2, ge=1, description="layers of the tagging head")

    @model_validator(mode="after")
    def _heads_fit(self):
        if self.width % self.num_heads:
            raise ValueError("width is no multiple of num_heads")
        return self
