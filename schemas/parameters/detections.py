"""Parameters of object proposals by foundation models."""

from typing import Annotated

from pydantic import Field, field_validator

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen


class DetectionParams(Frozen):
    """Which networks name, find, outline and track the objects of a section (proposals: detections)."""

    tagger: Annotated[str, ChoiceOf("detections.tagger")] = Field(
        "ram", description="names what is in a section's first frame"
    )
    tags: tuple[str, ...] | None = Field(None, description="names of objects to look for; with them nothing is tagged")
    masks: Annotated[str, ChoiceOf("detections.masks")] = Field(
        "sam-hq", description="outlines what the detector's boxes hold"
    )
    tracker: Annotated[str, ChoiceOf("detections.tracker")] = Field(
        "deaot", description="carries the masks through the section"
    )

    @field_validator("tags", mode="before")
    @classmethod
    def _split_names(cls, value: object) -> object:
        return tuple(name.strip() for name in value.split(",")) if isinstance(value, str) else value

    @field_validator("tags")
    @classmethod
    def _check_names(cls, value: tuple[str, ...] | None) -> tuple[str, ...] | None:
        if value is not None and not (value and all(name.strip() for name in value)):
            raise ValueError("names of objects, separated by commas")
        return value
