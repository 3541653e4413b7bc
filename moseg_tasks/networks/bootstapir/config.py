"""Sizes of a BootsTAPIR network."""

from pydantic import Field

from moseg.schemas.frozen import Frozen


class BootsTapirConfig(Frozen):
    """Sizes of a BootsTAPIR network; the defaults are those of the published ``bootstapir_checkpoint_v2``.

    With no convolutions after the encoder's stages it is TAPIR (``tapir_checkpoint_panning``).
    """

    widths: tuple[int, int, int, int] = Field((64, 128, 256, 256), description="channels of the encoder's four stages")
    extra_blocks: int = Field(5, ge=0, description="blocks of convolutions after the encoder's last stage")
    extra_expansion: int = Field(4, ge=1, description="their hidden channels, as a multiple of the last stage's")
    pooled_levels: int = Field(1, ge=0, description="halvings of the coarse map at which points are compared, too")
    radius: int = Field(3, ge=0, description="half side of the square compared at each resolution, cells")
    hidden: int = Field(512, ge=1, description="channels of the mixer")
    depth: int = Field(12, ge=0, description="blocks of the mixer")
    matching_side: int = Field(
        256, ge=32, multiple_of=8, description="side of the frames in which points are searched in all places, px"
    )

    @property
    def fine(self) -> int:
        """Channels of the fine map, at a quarter of the image's size."""
        return self.widths[1]

    @property
    def coarse(self) -> int:
        """Channels of the coarse map, at an eighth of the image's size."""
        return self.widths[3]

    @property
    def num_correlations(self) -> int:
        """Correlations of a point in one frame."""
        return (2 + self.pooled_levels) * (2 * self.radius + 1) ** 2
