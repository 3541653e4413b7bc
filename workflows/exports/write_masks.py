"""Masks as images: ``00000.png`` and so on, the value of a pixel its object's identity."""

import io
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from moseg.workflows.exports.outputs import OWN_MASK, mask_name
from moseg.workflows.exports.ownership import MARK, is_own_mask
from moseg.workflows.exports.palette import davis_palette
from moseg.workflows.process.atomic_write import atomic_path, blame_output, sweep_leftovers

LAST_PALETTE_IDENTITY = 254
"""A palette ends at 255, which is "void" to the tools of DAVIS and YouTube-VOS."""


def write_masks(folder: Path, labels: Iterable[np.ndarray]) -> int:
    """Write one PNG per frame, with the palette of DAVIS, one frame in memory at a time.

    A palette ends at 255: a frame with an identity beyond 254 is written as a 16-bit grey image. Either way a pixel's
    value is its identity. Masks of an earlier, longer run are removed, and half-written files of a killed run; nothing
    else in the folder is touched.

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
    with sweep_leftovers(folder):
        for index, frame in enumerate(labels):
            path = folder / mask_name(index)
            write_mask(path, frame)
            written.add(path.name)
    with blame_output(folder):
        for path in folder.iterdir():
            if OWN_MASK.fullmatch(path.name) and path.name not in written and is_own_mask(path):
                path.unlink()
    return len(written)


def write_mask(path: Path, labels: np.ndarray) -> None:
    """Write one frame's labels uint16 (y, x); raises InputError where the file cannot be written."""
    data = encode_mask(labels)
    with atomic_path(path) as temporary, blame_output(path):
        temporary.write_bytes(data)


def encode_mask(labels: np.ndarray) -> bytes:
    """Return one frame's labels uint16 (y, x) as a PNG file."""
    mark = PngInfo()
    mark.add_text("Software", MARK)
    stream = io.BytesIO()
    _label_image(labels).save(stream, format="PNG", pnginfo=mark)
    return stream.getvalue()


def _label_image(labels: np.ndarray) -> Image.Image:
    if labels.max(initial=0) > LAST_PALETTE_IDENTITY:
        return Image.fromarray(labels.astype(np.uint16))
    image = Image.fromarray(labels.astype(np.uint8))
    image.putpalette(davis_palette().tobytes())
    return image
