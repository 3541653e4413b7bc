"""Parameters of monocular depth."""

from typing import Literal

from moseg.schemas.frozen import Frozen
from pydantic import Field


class DepthParams(Frozen):
    """Where the relative inverse depth of each frame comes from."""

    method: Literal["none", "dpt-dinov2", "depth-anything-v2", "groundtruth", "folder"] = Field(
        "none", description="none, a network, exact maps of the data set, or a folder"
    )
