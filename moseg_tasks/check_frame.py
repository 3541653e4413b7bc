"""The check that an array is an RGB frame."""

import numpy as np

from moseg.schemas.errors import InputError


def check_frame(image: np.ndarray, where: str | None = None, size: tuple[int, int] | None = None) -> None:
    """Raise InputError unless this is an RGB frame: uint8 (y, x, 3), of `size` (y, x) if that is given."""
    is_frame = image.dtype == np.uint8 and image.ndim == 3 and image.shape[2] == 3 and image.size > 0
    if not is_frame or size not in (None, image.shape[:2]):
        height, width = size or ("y", "x")
        got, expected = f"{image.dtype} {image.shape}", f"uint8 ({height}, {width}, 3)"
        raise InputError("not an RGB frame", where=where, got=got, expected=expected)
