"""Parameters of the identities of objects across sections."""

from pydantic import Field

from schemas.frozen import Frozen


class LinkingParams(Frozen):
    """Identities of objects across sections that share frames."""

    min_iou: float = Field(
        0.3, gt=0, le=1, description="least overlap (IoU over the shared frames) of one object in two"
    )
