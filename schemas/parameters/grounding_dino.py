"""Parameters of open-vocabulary detection by Grounding DINO."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit

Separator = Literal["comma", "stop"]
"""Separator of names in a prompt: words of names separated by a full stop do not attend to each other."""


class GroundingDinoParams(Frozen):
    """Boxes of named objects in one frame.

    The thresholds and the text are those with which the authors' group runs RAM, Grounding DINO and SAM-HQ one after
    the other (``automatic_label_ram_demo.py`` of Grounded-Segment-Anything).
    """

    weights: str = Field("grounding-dino-tiny", description="weights item; `moseg backends` lists them")
    box_threshold: Annotated[float, Unit.PROBABILITY] = Field(
        0.25,
        ge=0,
        le=1,
        description="probability that the best matching token of the text must exceed, which is a box's score",
    )
    text_threshold: Annotated[float, Unit.PROBABILITY] = Field(
        0.2, ge=0, le=1, description="probability above which a word is part of a box's name; it takes no box away"
    )
    tags_per_prompt: Annotated[int, Unit.COUNT] = Field(
        100, ge=1, description="maximal number of names in one prompt; fewer if they exceed 256 tokens"
    )
    separator: Separator = Field(
        "comma",
        description="separator of the names in a prompt: comma, as the authors use for tags, or stop, as they use for "
        "names given by a user",
    )
    nms_iou: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=1, description="overlap (IoU) with a better box above which a box is dropped"
    )
    nms_per_tag: bool = Field(False, description="only boxes of one name compete; else those of all names")
    max_boxes: Annotated[int, Unit.COUNT] = Field(100, ge=1, description="maximal number of boxes, best scores first")
    input_scale: Annotated[float, Unit.SHARE] = Field(
        1.0,
        ge=0.3,
        le=1,
        description="share of the published input size (shorter side 800 px, longer at most 1333 px): less is faster"
        " and misses small objects",
    )
