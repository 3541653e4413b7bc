"""Sizes of a PIPs network."""

from pydantic import Field

from moseg.schemas.frozen import Frozen


class PipsConfig(Frozen):
    """Sizes of a PIPs network; the defaults are those of the published checkpoint, ``model-000200000``."""

    window: int = Field(8, ge=2, description="frames of a window")
    stride: int = Field(4, ge=1, description="pixels of the image to one cell of the feature maps")
    latent: int = Field(128, ge=1, description="channels of a point's appearance, and of the feature maps")
    widths: tuple[int, int, int, int] = Field((64, 96, 128, 128), description="channels of the encoder's four stages")
    levels: int = Field(4, ge=1, description="resolutions at which a point's appearance is compared with the maps")
    radius: int = Field(3, ge=0, description="half side of the square compared at each resolution, cells")
    encoding: int = Field(64, ge=2, multiple_of=2, description="sines and cosines of each coordinate of the motion")
    hidden: int = Field(512, ge=1, description="channels of the mixer")
    depth: int = Field(12, ge=0, description="blocks of the mixer")

    @property
    def num_correlations(self) -> int:
        """Correlations of a point in one frame."""
        return self.levels * (2 * self.radius + 1) ** 2

    @property
    def min_side(self) -> int:
        """Minimal side of an image whose coarsest feature map still has one cell, px."""
        return self.stride * 2 ** (self.levels - 1)
