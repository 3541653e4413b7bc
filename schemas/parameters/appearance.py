"""Parameters of the colours of what moves and of the background."""

from pydantic import Field

from schemas.frozen import Frozen


class AppearanceParams(Frozen):
    """Histograms over CIELAB of a section's moving and static pixels, and their ratio."""

    levels: int = Field(32, ge=2, le=40, description="bins of each of L, a and b")
    chroma_range: float = Field(
        96.0, gt=0, description="range of a and of b, around grey; what is beyond is in the last bin"
    )
    moving_sharpness: float = Field(5.0, gt=0, description="power of the probability to move in a pixel's weight")
    static_sharpness: float = Field(3.0, gt=0, description="the same for the probability to be static")
    unreliable_static: float = Field(
        0.3, ge=0, le=1, description="static weight of a pixel whose flow is never consistent"
    )
    misfit_weight: float = Field(
        1.0, ge=0, description="what the misfit to the own motion takes from the logit to move"
    )
    smoothing: float = Field(1.0, ge=0, description="sigma of the Gaussian over the histograms, bins")
    floor: float = Field(1e-6, gt=0, description="share of a bin that is empty on one side")
    doubt: float = Field(20.0, ge=0, description="weight of what moves, px, at which its colours count half")
    clip: float = Field(4.0, gt=0, description="largest log ratio")
    memory: float = Field(
        0.985, ge=0, le=1, description="weight of other sections' colours, to the power of the frames between"
    )
    reach: int = Field(4, ge=0, description="sections before and after whose colours count")
