"""Parameters of the probability of each pixel to move on its own."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ForegroundParams(Frozen):
    """Evidence of motion, of colour and of coherence, as logits that add up."""

    threshold: Annotated[float, Unit.PROBABILITY] = Field(
        0.6, gt=0, lt=1, description="accumulated saliency that speaks neither for nor against"
    )
    sharpness: Annotated[float, Unit.RATIO] = Field(
        1.5, gt=0, description="slope from the logit of saliency to that of the foreground"
    )
    colour_weight: Annotated[float, Unit.RATIO] = Field(0.9, ge=0, description="weight of the log ratio of colours")
    reliability_weight: Annotated[float, Unit.RATIO] = Field(
        1.0, ge=0, description="weight of flow less consistent than that of what moves"
    )
    reliability_floor: Annotated[float, Unit.RATIO] = Field(
        0.1, gt=0, description="added to consistencies before their ratio is taken"
    )
    misfit_weight: Annotated[float, Unit.RATIO] = Field(0.3, ge=0, description="weight of the misfit to the own motion")
    misfit_tolerance: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="spreads of the own motion that a pixel may deviate"
    )
