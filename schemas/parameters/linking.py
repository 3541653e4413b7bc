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
