"""Parameters of point tracking by BootsTAPIR."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class BootsTapirParams(Frozen):
    """Inference of the BootsTAPIR network; `TrackParams` are the parameters of the sampling.

    References
    ----------
    C. Doersch et al., "BootsTAP: Bootstrapped training for tracking-any-point", ACCV 2024.
    """

    weights: str = Field("bootstapir", description="weights item; `moseg backends` lists them")
    side: Annotated[int, Unit.PIXELS] = Field(
        512,
        ge=256,
        le=2048,
        multiple_of=8,
        description="frames are resized to a square of this side for the network, px; the authors find 512 the best and"
        " publish their figures at 256. Time and memory grow with its square: 17 MB a frame of a section at 512",
    )
    iterations: Annotated[int, Unit.COUNT] = Field(
        4, ge=1, description="steps of refinement at each size of the frames: 256, 512 and so on up to `side`"
    )
    min_visibility: Annotated[float, Unit.PROBABILITY] = Field(
        0.5,
        ge=0,
        le=1,
        description="probability of being visible and near the estimated position below which a point is hidden in a"
        " frame; 0.5 is the authors'",
    )
    points_per_pass: Annotated[int, Unit.COUNT] = Field(
        64, ge=1, description="points tracked at once: memory grows with it, about 0.3 MB a point and frame"
    )
