"""Parameters of the colours around each place of an outline."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class LocalColourParams(Frozen):
    """Colours of an object and of the background beside each other, in one frame."""

    share: Annotated[float, Unit.RATIO] = Field(
        1.0, ge=0, description="weight of their log ratio beside the logit of the foreground; 0: not asked"
    )
    radius: Annotated[float, Unit.PIXELS] = Field(
        8.0, ge=1, description="sigma of the Gaussian in which colours count, px of the working grid"
    )
    levels: Annotated[int, Unit.BINS] = Field(10, ge=2, le=40, description="bins of each of L, a and b")
    smoothing: Annotated[float, Unit.BINS] = Field(
        0.5, gt=0, description="sigma of the Gaussian over bins, in which colours are alike"
    )
    floor: Annotated[float, Unit.SHARE] = Field(0.005, gt=0, description="share of a colour that was not seen")
    doubt: Annotated[float, Unit.PIXELS] = Field(
        5.0, ge=0, description="summed weight of the pixels of the smaller side, px, at which its colours count half"
    )
    clip: Annotated[float, Unit.NATS] = Field(3.0, gt=0, description="largest log ratio")
