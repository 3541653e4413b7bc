"""Parameters of SAM 2.1 and EdgeTAM: masks from prompts, and masks tracked through a video."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class Sam2Params(Frozen):
    """Model size of SAM 2.1, and bounds on its memory."""

    weights: str = Field("sam2.1-hiera-large", description="weights item; `moseg backends` lists them")
    boxes_per_pass: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="boxes whose masks are decoded together: a bound on memory"
    )
    objects_per_pass: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="objects whose masks are encoded together: a bound on memory"
    )
    memory_reach: Annotated[int, Unit.FRAMES] = Field(
        15,
        ge=1,
        description="frames back that the memory of an object reaches, beside its first; the network itself looks at "
        "15 at most, at the masks of the last 6. These take 1.5 MB a frame and object, in float32",
    )


class EdgeTamParams(Sam2Params):
    """Weights of EdgeTAM, and bounds on its memory, which are those of SAM 2.1."""

    weights: str = Field("edgetam", description="weights item; `moseg backends` lists them")
