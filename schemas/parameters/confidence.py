"""Parameters of the estimates how sure and how complete each object is."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ConfidenceParams(Frozen):
    """Expected precision and recall of an object's mask, from the probability of each pixel to move.

    The offsets and slopes are those of logistic curves that `benchmarks/confidence/calibrate.py` fits.
    """

    reach: Annotated[float, Unit.RATIO] = Field(
        0.4,
        gt=0,
        description="how far around an object parts of it are sought, in square roots of its area",
    )
    prior: Annotated[float, Unit.COUNT] = Field(
        8.0, ge=0, description="pixels that are added to what an object covers, so that single pixels count little"
    )
    sure_offset: Annotated[float, Unit.RATIO] = Field(
        -1.32,
        ge=-20,
        le=20,
        description="logit of the expected precision where the mean probability in the mask is 1/2",
    )
    sure_slope: Annotated[float, Unit.RATIO] = Field(
        1.57, gt=0, description="growth of this logit with that of the mean probability"
    )
    complete_offset: Annotated[float, Unit.RATIO] = Field(
        -0.33,
        ge=-20,
        le=20,
        description="logit of the expected recall where the mask covers half of the probability around it",
    )
    complete_slope: Annotated[float, Unit.RATIO] = Field(
        1.1, gt=0, description="growth of this logit with that of the share of the probability"
    )
