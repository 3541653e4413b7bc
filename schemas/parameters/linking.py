"""Parameters of the identities of objects across sections."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class LinkingParams(Frozen):
    """Identities of objects across sections that share frames."""

    min_iou: Annotated[float, Unit.SHARE] = Field(
        0.3, gt=0, le=1, description="minimal overlap (IoU over the shared frames) of one object in two sections"
    )
    part_share: Annotated[float, Unit.SHARE] = Field(
        0.8,
        ge=0,
        le=1,
        description="minimal share of an object of saliency, over the shared frames, that lies in one of the other"
        " section, for it to be a later or earlier part of what is matched to that; 0: parts stay apart",
    )
