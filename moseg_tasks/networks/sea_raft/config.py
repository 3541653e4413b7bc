"""Sizes of SEA-RAFT."""

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.tasks.networks.raft import RaftConfig


class SeaRaftConfig(Frozen):
    """Widths and depths of SEA-RAFT's parts; the defaults are those of the published networks M and L.

    M and L share their weights: L iterates 12 times instead of 4.

    References
    ----------
    Wang, Lipson, Deng, "SEA-RAFT: Simple, Efficient, Accurate RAFT for Optical Flow", ECCV 2024, section 3.
    """

    num_blocks: tuple[int, int, int] = Field(
        (3, 4, 6), description="blocks of both encoders at 1/2, 1/4 and 1/8 of the size: ResNet-34's, or ResNet-18's"
    )
    stage_channels: tuple[int, int, int] = Field((64, 128, 256), description="channels at 1/2, 1/4 and 1/8 of the size")
    hidden_channels: int = Field(
        128, ge=4, multiple_of=4, description="channels of the recurrent state; half of those that are correlated"
    )
    correlation_levels: int = Field(4, ge=1, description="levels of the correlation pyramid")
    correlation_radius: int = Field(4, ge=0, description="half side of a look-up window, cells")
    num_refinements: int = Field(2, ge=1, description="ConvNeXt blocks of an iteration")

    def motion_encoder(self) -> RaftConfig:
        """Return the sizes of RAFT's encoder of correlations and flow, which SEA-RAFT keeps."""
        hidden = self.hidden_channels
        return RaftConfig(
            correlation_levels=self.correlation_levels,
            correlation_radius=self.correlation_radius,
            correlation_channels=(2 * hidden, hidden + hidden // 2),
            flow_channels=(hidden, hidden // 2),
            motion_channels=hidden,
        )


MEDIUM = SeaRaftConfig()
SMALL = SeaRaftConfig(num_blocks=(2, 2, 2))
