"""Parameters of the objects of a frame and of how they take over those already tracked."""

from typing import Annotated

from pydantic import Field, model_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class InstanceParams(Frozen):
    """Which of the masks found in a frame become objects."""

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
        0.0005, ge=0, le=1, description="least area of an object, share of the frame"
    )
    max_area: Annotated[float, Unit.SHARE] = Field(
        0.8, gt=0, le=1, description="masks larger than this are background, share of the frame; 1: none"
    )
    max_objects: Annotated[int, Unit.COUNT] = Field(
        20, ge=1, le=65535, description="objects kept at most, best score first"
    )

    @model_validator(mode="after")
    def _check_areas(self):
        if self.min_area >= self.max_area:
            raise ValueError("min_area must be under max_area")
        return self


class SeedParams(Frozen):
    """How the objects found in a section's first frame and those tracked into it become the section's seeds."""

    min_iou: Annotated[float, Unit.SHARE] = Field(
        0.5, gt=0, le=1, description="least overlap (IoU) of a found mask with the tracked object it is"
    )
    refresh: bool = Field(
        True, description="a tracked object that is found again goes on with the found mask; else with the tracked one"
    )
    min_area: Annotated[float, Unit.SHARE] = Field(
        0.0001, ge=0, le=1, description="a tracked mask below this is lost, share of the frame"
    )
    max_area: Annotated[float, Unit.SHARE] = Field(
        0.8, gt=0, le=1, description="a tracked mask above this has leaked, share of the frame; 1: none has"
    )
    newcomer_share: Annotated[float, Unit.SHARE] = Field(
        0.8, gt=0, le=1, description="share of a found object that must be free of tracked ones to make it a newcomer"
    )
    max_objects: Annotated[int, Unit.COUNT] = Field(
        40, ge=1, le=65535, description="objects of a section at most; newcomers beyond are left out, worst score first"
    )
