"""Names of what `moseg segment` leaves in its folder."""

import re

MASKS, OVERLAY, MOTION = "masks", "overlay.mp4", "motion.json"
OWN_MASK = re.compile(r"\d{5,}\.png")
"""Names of the masks in their folder."""


def mask_name(index: int) -> str:
    """File name of the mask of a frame, counted from 0."""
    return f"{index:05d}.png"
