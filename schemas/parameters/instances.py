"""Parameters of the objects of a frame and of their association with tracked objects."""

from typing import Annotated

from pydantic import Field, model_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class InstanceParams(Frozen):
    """Selection of objects among the masks of a frame."""

    nms_iou: Annotated[float, Unit.SHARE] = Field(
        0.7, ge=0, le=1, description="overlap (IoU) with a better mask above which a mask is dropped"
    )
    containment: Annotated[float, Unit.SHARE] = Field(
        0.9,
        ge=0,
        le=1,
        description="share of a mask inside a better one above which it is dropped, as a part; 1: never",
    )
    min_area: Annotated[float, Unit.SHARE] = Field(
        0.0005, ge=0, le=1, description="minimal area of an object, share of the frame"
    )
    max_area: Annotated[float, Unit.SHARE] = Field(
        0.8, gt=0, le=1, description="masks larger than this are background, share of the frame; 1: none"
    )
    max_objects: Annotated[int, Unit.COUNT] = Field(
        20, ge=1, le=65535, description="maximal number of objects, best scores first"
    )

    @model_validator(mode="after")
    def _check_areas(self):
        if self.min_area >= self.max_area:
            raise ValueError("min_area must be under max_area")
        return self


class SeedParams(Frozen):
    """Combination of the objects found in a section's first frame and those tracked into it, to the section's seeds."""

    min_iou: Annotated[float, Unit.SHARE] = Field(
        0.5, gt=0, le=1, description="minimal overlap (IoU) of a found mask with its tracked object"
    )
    refresh: bool = Field(
        True,
        description="a tracked object that is found again continues with the found mask; else with the tracked one",
    )
    min_area: Annotated[float, Unit.SHARE] = Field(
        0.0001, ge=0, le=1, description="a tracked mask below this is lost, share of the frame"
    )
    max_area: Annotated[float, Unit.SHARE] = Field(
        0.8, gt=0, le=1, description="a tracked mask above this has leaked, share of the frame; 1: none has"
    )
    newcomer_share: Annotated[float, Unit.SHARE] = Field(
        0.8, gt=0, le=1, description="share of a found object outside all tracked ones from which it is a new object"
    )
    max_objects: Annotated[int, Unit.COUNT] = Field(
        40,
        ge=1,
        le=65535,
        description="maximal number of objects of a section; new objects beyond are dropped, worst scores first",
    )
