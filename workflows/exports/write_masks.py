"""Masks as images: ``00000.png`` and so on, the value of a pixel its object's identity."""

import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from PIL import Image

from workflows.exports.atomic_write import atomic_path, blame_output
from workflows.exports.palette import davis_palette

# 255 is "void" to the tools of DAVIS and YouTube-VOS.
_LAST_PALETTE_IDENTITY = 254
_OWN_NAME = re.compile(r"\d{5,}\.png")


def write_masks(folder: Path, labels: Iterable[np.ndarray]) -> int:
    """Write one PNG per frame, with the palette of DAVIS, one frame in memory at a time.

    A palette ends at 255: a frame with an identity beyond 254 is written as a 16-bit grey image. Either way a pixel's
    value is its identity. Numbered images that an earlier, longer run left in the folder are removed; nothing else in
    it is touched.

    Parameters
    ----------
    folder : Path
        Created where it is absent.
    labels : iterable of uint16 (y, x)
        0 = static.

    Returns
    -------
    int
        Number of frames written.

    Raises
    ------
    InputError
        Where the folder cannot be written.
    """
    folder = Path(folder)
    written = set()
    with blame_output(folder):
        folder.mkdir(parents=True, exist_ok=True)
    for index, frame in enumerate(labels):
        path = folder / f"{index:05d}.png"
        image = _label_image(frame)
        with atomic_path(path) as temporary, blame_output(path):
            image.save(temporary, format="PNG")
        written.add(path.name)
    with blame_output(folder):
        for path in folder.iterdir():
            if _OWN_NAME.fullmatch(path.name) and path.name not in written:
                path.unlink()
    return len(written)


def _label_image(labels: np.ndarray) -> Image.Image:
    if labels.max(initial=0) > _LAST_PALETTE_IDENTITY:
        return Image.fromarray(labels.astype(np.uint16))
    image = Image.fromarray(labels.astype(np.uint8))
    image.putpalette(davis_palette().tobytes())
    return image
