"""Parameters of image tagging by RAM and RAM++."""

from typing import Annotated

from pydantic import Field, field_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.comma_separated import split_commas
from moseg.schemas.units import Unit


class RamParams(Frozen):
    """Selection of a frame's tags for detection.

    All tags are used, up to `max_tags`, unless some are excluded. The tagger also names scenes, colours and actions
    ("sky", "blue", "walk"), and no list of those of its 4,585 tags that name things comes with it.
    """

    weights: str | None = Field(
        None, description="weights item, that of the tagger's own name if none; `moseg backends` lists them"
    )
    threshold_scale: Annotated[float, Unit.RATIO] = Field(
        1.0, ge=0, description="factor of the published thresholds of the tags' probabilities; lower finds more tags"
    )
    max_tags: Annotated[int, Unit.COUNT] = Field(
        100, ge=1, description="maximal number of tags of a frame, the most probable ones"
    )
    excluded_tags: tuple[str, ...] = Field((), description="ignored tags, in the spelling of the tagger's list")

    _split_excluded_tags = field_validator("excluded_tags", mode="before")(split_commas)
