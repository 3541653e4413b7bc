"""Parameters of masks from boxes by SAM-HQ."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class SamHqParams(Frozen):
    """Masks of the boxes of one frame."""

    weights: str = Field("sam-hq-vit-large", description="weights item; `moseg backends` lists them")
    hq_token_only: bool = Field(
        False,
        description="only the masks of the high-quality token, for frames of one object; else added to SAM's masks",
    )
    boxes_per_pass: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="boxes whose masks are decoded together: a bound on memory"
    )
