"""Parameters of objects as components of the foreground."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ComponentParams(Frozen):
    """Space-time components of the foreground, and the selection of objects among them."""

    border_share: Annotated[float, Unit.SHARE] = Field(
        0.4, gt=0, le=1, description="share of outline on the frame's border at which a score is 0"
    )
    score_ratio: Annotated[float, Unit.SHARE] = Field(
        0.1, ge=0, le=1, description="objects below this share of the best score are dropped"
    )
    min_area: Annotated[float, Unit.SHARE] = Field(
        0.0005, ge=0, le=1, description="minimal mean area over its frames, share of the frame"
    )
    max_objects: Annotated[int, Unit.COUNT] = Field(
        16, ge=1, le=65535, description="maximal number of objects, best scores first"
    )
