"""Sizes of Depth Anything 3."""

from pydantic import Field

from moseg.schemas.frozen import Frozen


class DepthAnything3Config(Frozen):
    """Widths and depths of the transformer and of the head of depth; the defaults are those of the small network.

    References
    ----------
    Lin et al., "Depth Anything 3: Recovering the Visual Space from Any Views", 2025, section 3.
    """

    width: int = Field(384, ge=4, description="channels of a token")
    num_layers: int = Field(12, ge=1, description="blocks of the transformer")
    num_heads: int = Field(6, ge=1, description="attention heads; each has a multiple of 4 channels")
    grid_side: int = Field(37, ge=1, description="side of the grid of learned positions, cells of 14 px")
    multi_view_from: int = Field(
        4,
        ge=0,
        description="first block that normalises and rotates queries and keys, as those need that see other views",
    )
    output_layers: tuple[int, int, int, int] = Field((5, 7, 9, 11), description="blocks whose tokens the head reads")
    stage_channels: tuple[int, int, int, int] = Field(
        (48, 96, 192, 384), description="channels of the head's maps at 4, 2, 1 and 1/2 times the patches"
    )
    fusion_channels: int = Field(64, ge=8, multiple_of=8, description="channels of the fused maps")


SMALL = DepthAnything3Config()
BASE = DepthAnything3Config(width=768, num_heads=12, stage_channels=(96, 192, 384, 768), fusion_channels=128)
