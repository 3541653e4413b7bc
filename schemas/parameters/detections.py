"""Parameters of object proposals by foundation models."""

from typing import Annotated

from pydantic import Field, field_validator

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.comma_separated import are_names, split_commas


class DetectionParams(Frozen):
    """Networks that tag, detect, segment and track the objects of a section (proposals: detections)."""

    tagger: Annotated[str, ChoiceOf("detections.tagger")] = Field(
        "ram", description="network that tags a section's first frame"
    )
    tags: tuple[str, ...] | None = Field(
        None, description="names of objects to detect, instead of tagging, or of SAM 3's concepts"
    )
    masks: Annotated[str, ChoiceOf("detections.masks")] = Field(
        "sam-hq", description="network that outlines the objects of the detector's boxes, or of moving regions"
    )
    tracker: Annotated[str, ChoiceOf("detections.tracker")] = Field(
        "deaot", description="network that tracks the masks through the section"
    )

    _split_tags = field_validator("tags", mode="before")(split_commas)

    @field_validator("tags")
    @classmethod
    def _check_names(cls, value: tuple[str, ...] | None) -> tuple[str, ...] | None:
        if value is not None and not are_names(value):
            raise ValueError("names of objects, separated by commas")
        return value
