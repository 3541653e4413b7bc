"""Units of parameters."""

from enum import StrEnum


class Unit(StrEnum):
    """Unit of a parameter, in the annotation of its field."""

    PIXELS = "px"
    SQUARED_PIXELS = "px²"
    DEGREES = "degrees"
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
    """Share of the quantity in the description: 1 is all of it."""
    PERCENT = "%"
    NATS = "nats"
    RATIO = "ratio"
    """A factor, weight, power or other number without a dimension."""
    SEED = "seed"
