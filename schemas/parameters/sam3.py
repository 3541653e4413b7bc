"""Parameters of SAM 3: objects that phrases name, and masks tracked through a video."""

from typing import Annotated

from pydantic import Field, field_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.comma_separated import are_names, split_commas
from moseg.schemas.units import Unit

MOVING_THINGS = (
    "person",
    "animal",
    "car",
    "truck",
    "bus",
    "train",
    "motorcycle",
    "bicycle",
    "boat",
    "airplane",
    "skateboard",
    "ball",
)
"""What often moves in videos. Each phrase is a pass of the network, so kinds that one word covers are not listed."""


class Sam3Params(Frozen):
    """Weights of SAM 3, what it looks for, and bounds on its memory."""

    weights: str = Field("sam3", description="weights item; `moseg backends` lists them")
    concepts: tuple[str, ...] = Field(
        MOVING_THINGS,
        description="singular nouns, or short phrases of one, that name the objects to find, separated by commas; "
        "`--tags` gives others. Each is a pass of the network's smaller part",
    )
    min_score: Annotated[float, Unit.PROBABILITY] = Field(
        0.5,
        ge=0,
        le=1,
        description="probability that an object is the named thing, above which it is found; the authors' value",
    )
    objects_per_pass: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="objects whose masks are enlarged, or encoded, together: a bound on memory"
    )
    memory_reach: Annotated[int, Unit.FRAMES] = Field(
        15,
        ge=1,
        description="frames back that the memory of an object reaches, beside its first; the network itself looks at "
        "15 at most, at the masks of the last 6. These take 2 MB a frame and object",
    )

    _split_concepts = field_validator("concepts", mode="before")(split_commas)

    @field_validator("concepts")
    @classmethod
    def _check_names(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        if not are_names(value):
            raise ValueError("names of objects, separated by commas")
        return value
