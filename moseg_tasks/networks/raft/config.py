"""Sizes of RAFT."""

from typing import Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen


class RaftConfig(Frozen):
    """Kinds and widths of RAFT's parts; the defaults are those of the published large network.

    References
    ----------
    Teed, Deng, "RAFT: Recurrent All-Pairs Field Transforms for Optical Flow", ECCV 2020, appendix A.
    """

    block: Literal["residual", "bottleneck"] = Field("residual", description="block of both encoders")
    stage_channels: tuple[int, int, int] = Field((64, 96, 128), description="channels at 1/2, 1/4 and 1/8 of the size")
    feature_channels: int = Field(256, ge=1, description="channels that are correlated")
    has_context_norm: bool = Field(True, description="batch normalisation in the context encoder")
    hidden_channels: int = Field(128, ge=1, description="channels of the recurrent state")
    context_channels: int = Field(128, ge=1, description="channels of the context")
    correlation_levels: int = Field(4, ge=1, description="levels of the correlation pyramid")
    correlation_radius: int = Field(4, ge=0, description="half side of a look-up window, cells")
    correlation_channels: tuple[int, ...] = Field(
        (256, 192), min_length=1, max_length=2, description="channels of the convolutions of the correlations"
    )
    flow_channels: tuple[int, int] = Field((128, 64), description="channels of the convolutions of the flow")
    motion_channels: int = Field(128, ge=3, description="channels of the motion features; two of them are the flow")
    gru_kernels: tuple[tuple[int, int], ...] = Field(
        ((1, 5), (5, 1)), min_length=1, max_length=2, description="(y, x) kernels of the recurrent units, in turn"
    )
    head_channels: int = Field(256, ge=1, description="hidden channels of the flow head")
    mask_channels: int | None = Field(
        256, ge=1, description="hidden channels of the upsampling head; None: upsampled bilinearly"
    )


LARGE = RaftConfig()
SMALL = RaftConfig(
    block="bottleneck",
    stage_channels=(32, 64, 96),
    feature_channels=128,
    has_context_norm=False,
    hidden_channels=96,
    context_channels=64,
    correlation_radius=3,
    correlation_channels=(96,),
    flow_channels=(64, 32),
    motion_channels=82,
    gru_kernels=((3, 3),),
    head_channels=128,
    mask_channels=None,
)
