"""Parameters of monocular depth."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen


class DepthParams(Frozen):
    """Source of the relative inverse depth of each frame."""

    method: Annotated[str, ChoiceOf("depth.method")] = Field(
        "none", description="none, a network, exact maps of the data set, or a folder"
    )
