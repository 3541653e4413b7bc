"""Sizes of a Swin Transformer."""

from pydantic import Field, model_validator

from moseg.schemas.frozen import Frozen


class SwinConfig(Frozen):
    """Sizes of the encoder; the defaults are Swin-L's for images of 384 x 384 px.

    References
    ----------
    Liu et al., "Swin Transformer: Hierarchical Vision Transformer using Shifted Windows", ICCV 2021, section 3.3.
    """

    image_size: int = Field(384, ge=1, description="side of the square input image, px")
    patch_size: int = Field(4, ge=1, description="side of the patch that becomes one token, px")
    embed_dim: int = Field(192, ge=1, description="channels of the first stage; each further stage doubles them")
    depths: tuple[int, ...] = Field((2, 2, 18, 2), min_length=1, description="blocks of each stage")
    num_heads: tuple[int, ...] = Field((6, 12, 24, 48), min_length=1, description="attention heads of each stage")
    window_size: int = Field(12, ge=1, description="side of the attention window, tokens")
    mlp_ratio: int = Field(
        4, ge=1, description="hidden channels of a block's perceptron, as a multiple of its channels"
    )

    @model_validator(mode="after")
    def _stages_fit(self):
        if len(self.depths) != len(self.num_heads):
            raise ValueError("depths and num_heads name different numbers of stages")
        if self.image_size != self.patch_size * self.side(0):
            raise ValueError("image_size is no multiple of patch_size")
        for stage, heads in enumerate(self.num_heads):
            side = self.side(stage)
            if self.width(stage) % heads or side % self.window(stage):
                raise ValueError(f"stage {stage} cannot be cut into its heads or windows")
            if stage + 1 < len(self.depths) and side % 2:
                raise ValueError(f"stage {stage} has an odd side and cannot be merged")
        return self

    def side(self, stage: int) -> int:
        """Return the side of the token grid of a stage, tokens."""
        return self.image_size // self.patch_size // 2**stage

    def width(self, stage: int) -> int:
        """Return the number of channels of a stage."""
        return self.embed_dim * 2**stage

    def window(self, stage: int) -> int:
        """Return the side of a stage's window, which is at most that of its grid."""
        return min(self.window_size, self.side(stage))

    @property
    def output_width(self) -> int:
        """Channels of the encoder's tokens."""
        return self.width(len(self.depths) - 1)
