"""Parameters of monocular depth."""

from typing import Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen


class DepthParams(Frozen):
    """Source of the relative inverse depth of each frame."""

    method: Literal["none", "dpt-dinov2", "depth-anything-v2", "groundtruth", "folder"] = Field(
        "none", description="none, a network, exact maps of the data set, or a folder"
    )
