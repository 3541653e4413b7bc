"""Parameters of the cameras of frame pairs by a network."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class CameraParams(Frozen):
    """Source of the camera's motion over the frame pairs of `rigidity`.

    The weights and the input size of the network are those of `depth_anything_3`.
    """

    method: Annotated[str, ChoiceOf("cameras.method")] = Field(
        "tracks", description="fitted to point tracks, or a network that relates several frames"
    )
    views: Annotated[int, Unit.FRAMES] = Field(
        16, ge=2, description="frames that the network sees at once; at least those that a pair spans"
    )
