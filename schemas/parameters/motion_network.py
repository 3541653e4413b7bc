"""Parameters of the motion network: what it adds to the evidence of saliency."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class MotionNetworkParams(Frozen):
    """Use of the network that was trained on rendered scenes: its logit is averaged with that of saliency."""

    use: Literal["always", "never"] = Field(
        "always", description="whether the network looks at the motion of each frame, in addition to saliency"
    )
    weights: str = Field(
        "", description="an ONNX file of `moseg train`; by default the network that comes with this program"
    )
    step: Annotated[int, Unit.FRAMES] = Field(
        3,
        ge=1,
        le=8,
        description="frames between those that the network looks at; the logit of a frame beside them is carried along"
        " the flow, from one or from both, and of the others there is none",
    )
    share: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=1, description="weight of the network's logit; that of saliency has the rest"
    )
    gain: Annotated[float, Unit.RATIO] = Field(1.0, gt=0, description="factor of the network's logit")
    limit: Annotated[float, Unit.RATIO] = Field(
        4.0, gt=0, description="largest absolute logit of the network after the gain, so that it is never certain alone"
    )
