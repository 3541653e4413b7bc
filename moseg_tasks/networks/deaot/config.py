"""Sizes of DeAOT."""

from pydantic import Field

from moseg.schemas.frozen import Frozen


class DeaotConfig(Frozen):
    """Widths and depths of DeAOT's parts; the defaults are those of the published R50-DeAOTL."""

    stem_width: int = Field(64, ge=1, description="channels of the encoder's first convolution")
    stage_widths: tuple[int, int, int] = Field(
        (64, 128, 256), description="inner channels of the encoder's stages; their outputs have four times as many"
    )
    stage_depths: tuple[int, int, int] = Field((3, 4, 6), description="bottlenecks of each stage")
    d_model: int = Field(
        256, ge=16, multiple_of=16, description="channels of each branch; half of them are normalised in 8 groups"
    )
    num_layers: int = Field(3, ge=1, description="gated propagation modules")
    max_objects: int = Field(10, ge=1, description="objects that one pass holds")
    window_radius: int = Field(7, ge=1, description="radius of short-term propagation, cells of 16 px")
