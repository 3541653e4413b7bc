"""Parameters of objects as components of the foreground."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ComponentParams(Frozen):
    """Space-time components of the foreground, and the selection of objects among them."""

    border_share: Annotated[float, Unit.SHARE] = Field(
        0.4, gt=0, le=1, description="share of outline on the frame's border at which a score is 0"
    )
    full_frame: Annotated[float, Unit.SHARE] = Field(
        0.7,
        gt=0,
        le=1,
        description="share of the frame from which an object fills it: its outline is then not counted",
    )
    score_ratio: Annotated[float, Unit.SHARE] = Field(
        0.1,
        ge=0,
        le=1,
        description="objects below this share of the best score are dropped if not clear by themselves",
    )
    own_probability: Annotated[float, Unit.PROBABILITY] = Field(
        0.8, ge=0, le=1, description="mean probability to move over its pixels from which an object is clear by itself"
    )
    own_frames: Annotated[int, Unit.FRAMES] = Field(
        10, ge=1, description="frames, or the whole section if it is shorter, for which it must be visible"
    )
    min_area: Annotated[float, Unit.SHARE] = Field(
        0.0005, ge=0, le=1, description="minimal mean area over its frames, share of the frame"
    )
    max_objects: Annotated[int, Unit.COUNT] = Field(
        16, ge=1, le=65535, description="maximal number of objects, best scores first"
    )
    hole_probability: Annotated[float, Unit.PROBABILITY] = Field(
        0.25,
        ge=0,
        le=1,
        description="mean probability to move from which a hole belongs to the object around it, unless it is plain, "
        "where less suffices; 1 fills none",
    )
    hole_plain_share: Annotated[float, Unit.SHARE] = Field(
        0.25, ge=0, le=1, description="share of this probability that suffices where a hole has a single colour"
    )
    hole_roughness: Annotated[float, Unit.GREY_LEVELS] = Field(
        7.0, gt=0, description="mean difference of a hole's colours 2 px apart from which it is not plain, grey levels"
    )
    hole_error: Annotated[float, Unit.GREY_LEVELS] = Field(
        10.0,
        ge=0,
        description="colour error that the background's motion leaves in a hole, at most; more, in proportion, where "
        "the hole is less than half as rough as hole_roughness, grey levels",
    )
    hole_border: Annotated[float, Unit.SHARE] = Field(
        0.3,
        ge=0,
        le=0.5,
        description="largest share of a hole's outline on one side of the frame; 0 fills only holes that the object "
        "surrounds",
    )
