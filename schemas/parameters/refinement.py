"""Parameters of outlines at full size."""

from pydantic import Field

from schemas.frozen import Frozen


class RefinementParams(Frozen):
    """Guided filter of the foreground by the frame's colours."""

    radius: int = Field(3, ge=1, description="half side of the filter's window, px of the working grid")
    smoothness: float = Field(
        1e-4, ge=1e-4, description="variance of colour, squared share of white, that counts as an edge"
    )
