"""Parameters of monocular depth."""

from typing import Literal

from pydantic import Field

from schemas.frozen import Frozen


class DepthParams(Frozen):
    """Where the relative inverse depth of each frame comes from."""

    method: Literal["none", "groundtruth", "folder"] = Field(
        "none", description="none, exact maps of the data set, or a folder"
    )
