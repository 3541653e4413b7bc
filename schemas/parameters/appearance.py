"""Parameters of the colours of moving objects and of the background."""

from typing import Annotated

from pydantic import Field, model_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class AppearanceParams(Frozen):
    """Histograms over CIELAB and texture of a section's moving and static pixels, and their ratio."""

    levels: Annotated[int, Unit.BINS] = Field(16, ge=2, le=40, description="bins of each of L, a and b")
    chroma_range: Annotated[float, Unit.GREY_LEVELS] = Field(
        96.0, gt=0, description="range of a and of b, around grey; values beyond are in the last bin"
    )
    texture_levels: Annotated[int, Unit.BINS] = Field(
        8,
        ge=1,
        le=8,
        description="bins of texture, the local deviation of L, which grow with it; 1: colour alone. All bins together "
        "are at most 65536",
    )
    texture_range: Annotated[float, Unit.GREY_LEVELS] = Field(
        40.0, gt=0, description="deviation beyond which all are in the last bin"
    )
    texture_scale: Annotated[float, Unit.PIXELS] = Field(
        2.0, gt=0, description="sigma of the Gaussian in which the deviation is taken, px"
    )
    moving_sharpness: Annotated[float, Unit.RATIO] = Field(
        5.0, gt=0, description="power of the probability of moving in a pixel's weight"
    )
    static_sharpness: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="the same for the probability of being static"
    )
    unreliable_static: Annotated[float, Unit.RATIO] = Field(
        0.3, ge=0, le=1, description="static weight of a pixel whose flow is never consistent"
    )
    misfit_weight: Annotated[float, Unit.RATIO] = Field(
        1.0, ge=0, description="weight of the own-motion residual that is subtracted from the logit of moving"
    )
    smoothing: Annotated[float, Unit.BINS] = Field(
        0.35, ge=0, description="sigma of the Gaussian over the histograms, bins of L, a and b"
    )
    texture_smoothing: Annotated[float, Unit.BINS] = Field(
        0.7, ge=0, description="the same, bins of the local deviation"
    )
    floor: Annotated[float, Unit.SHARE] = Field(
        1e-6, gt=0, description="share assigned to a bin that is empty in one histogram"
    )
    doubt: Annotated[float, Unit.PIXELS] = Field(
        20.0, ge=0, description="summed weight of moving pixels, px, at which their colours count half"
    )
    texture_doubt: Annotated[float, Unit.PIXELS] = Field(
        3.0,
        gt=0,
        description="summed weight of the pixels of a colour on both sides of a frame, px, at which its textures count "
        "half",
    )
    clip: Annotated[float, Unit.NATS] = Field(4.0, gt=0, description="largest log ratio")
    memory: Annotated[float, Unit.RATIO] = Field(
        0.985, ge=0, le=1, description="weight of other sections' colours, to the power of the frames between"
    )
    reach: Annotated[int, Unit.SECTIONS] = Field(4, ge=0, description="sections before and after whose colours count")

    @model_validator(mode="after")
    def _check_bins(self) -> "AppearanceParams":
        """Refuse histograms of more bins than 16 bits count."""
        if self.levels**3 * self.texture_levels > 2**16:
            raise ValueError("levels and texture_levels of at most 65536 bins: levels^3 * texture_levels")
        return self
