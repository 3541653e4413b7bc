"""Units of parameters."""

from enum import StrEnum


class Unit(StrEnum):
    """What the numbers of a parameter count or measure; stands in the annotation of the parameter's field."""

    PIXELS = "px"
    SQUARED_PIXELS = "px²"
    PIXELS_PER_FRAME = "px/frame"
    SQUARED_PIXELS_PER_FRAME = "(px/frame)²"
    PER_FRAME = "1/frame"
    METRES = "m"
    GREY_LEVELS = "grey levels"
    BINS = "bins"
    FRAMES = "frames"
    SECTIONS = "sections"
    COUNT = "count"
    PROBABILITY = "probability"
    SHARE = "share"
    """Of what the description names: 1 is all of it."""
    PERCENT = "%"
    NATS = "nats"
    RATIO = "ratio"
    """A factor, weight, power or anything else without a dimension."""
    SEED = "seed"
