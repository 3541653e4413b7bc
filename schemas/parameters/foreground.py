"""Parameters of each pixel's probability of independent motion."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ForegroundParams(Frozen):
    """Evidence of motion, of colour and of coherence, as a sum of logits."""

    threshold: Annotated[float, Unit.PROBABILITY] = Field(
        0.6, gt=0, lt=1, description="accumulated saliency at which the evidence of motion is 0"
    )
    sharpness: Annotated[float, Unit.RATIO] = Field(
        1.5, gt=0, description="slope from the logit of saliency to that of the foreground"
    )
    colour_weight: Annotated[float, Unit.RATIO] = Field(0.9, ge=0, description="weight of the log ratio of colours")
    reliability_weight: Annotated[float, Unit.RATIO] = Field(
        1.0, ge=0, description="weight of flow that is less consistent than that of moving pixels"
    )
    reliability_floor: Annotated[float, Unit.RATIO] = Field(
        0.1, gt=0, description="added to consistencies before their ratio is taken"
    )
    misfit_weight: Annotated[float, Unit.RATIO] = Field(
        0.3, ge=0, description="weight of the residual to the own motion"
    )
    misfit_tolerance: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="tolerated deviation of a pixel, in spreads of the own motion"
    )
