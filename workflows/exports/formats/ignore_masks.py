"""Grey masks of what moves: for reconstructions, which must ignore it, a little dilated, and for editors."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation
from moseg.workflows.process.atomic_write import atomic_path, blame_output

DEFAULT_DILATION = 5
"""Px. Features are found on the borders of moving objects, and masks are a few pixels off there."""


class Polarity(NamedTuple):
    """Values of the pixels to ignore and of those to use."""

    ignored: int
    used: int


def write_ignore_masks(target: OwnedFolder, saved: SavedSegmentation, polarity: Polarity, dilation: int) -> Path:
    """Write one 8-bit grey PNG per frame under the names of the folder, and return the folder.

    Parameters
    ----------
    target : OwnedFolder
        With one name for each frame.
    saved : SavedSegmentation
    polarity : Polarity
    dilation : int
        Px by which moving objects are dilated.

    Raises
    ------
    InputError
        A mask cannot be read, or the folder cannot be written.
    """
    folder = target.folder
    with target:
        for name, labels in zip(target.names, saved.labels(), strict=True):
            moves = dilate_moving(labels, dilation)
            image = Image.fromarray(np.where(moves, polarity.ignored, polarity.used).astype(np.uint8))
            with atomic_path(folder / name) as temporary, blame_output(folder / name):
                image.save(temporary, format="PNG")
    return folder


def dilate_moving(labels: np.ndarray, dilation: int) -> np.ndarray:
    """Return the pixels within `dilation` px of a moving one, bool (y, x), of uint16 (y, x) labels, 0 = static."""
    if dilation < 0:
        raise InputError("impossible dilation", got=dilation, expected="0 px or more")
    moves = labels > 0
    if not dilation or not moves.any():
        return moves
    return cv2.distanceTransform((~moves).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) <= dilation


def check_png_names(names: tuple[str, ...]) -> None:
    """Raise InputError where a frame is no PNG file: a mask of DynaSLAM has the name of its frame."""
    for name in names:
        if not name.lower().endswith(".png"):
            raise InputError("not a PNG file", where="dynaslam", got=name, expected="frames whose names end in .png")


def mask_format(
    name: str,
    description: str,
    mask_name: Callable[[str], str],
    polarity: Polarity,
    default_dilation: int = DEFAULT_DILATION,
    check_names: Callable[[tuple[str, ...]], None] | None = None,
) -> ExportFormat:
    """Return a format that writes one mask for each frame into the folder `name`, named after the frame's file."""

    def target(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFolder:
        return OwnedFolder(folder / name, map(mask_name, names))

    def write(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
        if check_names is not None:
            check_names(saved.names)
        masks = target(folder, saved.summary.name, saved.names)
        return write_ignore_masks(masks, saved, polarity, default_dilation if dilation is None else dilation)

    return ExportFormat(name, description, write, target, True, check_names)


COLMAP = mask_format(
    "colmap",
    "colmap/<frame file>.png, black where it moves: COLMAP's --ImageReader.mask_path",
    lambda frame: f"{frame}.png",
    Polarity(0, 255),
)
"""COLMAP's documentation, "Frequently Asked Questions", section "Mask image regions"."""

NERFSTUDIO = mask_format(
    "nerfstudio",
    "nerfstudio/<frame>.png, black where it moves: mask_path of transforms.json",
    lambda frame: f"{Path(frame).stem}.png",
    Polarity(0, 255),
)
"""nerfstudio's documentation, "Data conventions", section "Masks"."""

INSTANT_NGP = mask_format(
    "instant-ngp",
    "instant-ngp/dynamic_mask_<frame>.png, white where it moves: beside instant-ngp's images",
    lambda frame: f"dynamic_mask_{Path(frame).stem}.png",
    Polarity(255, 0),
)
"""instant-ngp's README, "How to mask away NeRF training pixels (e.g. for dynamic object removal)?"."""

DYNASLAM = mask_format(
    "dynaslam",
    "dynaslam/<frame file>, 1 where it moves: PATH_TO_MASKS of DynaSLAM",
    lambda frame: frame,
    Polarity(1, 0),
    0,
    check_png_names,
)
"""Bescos et al., "DynaSLAM: Tracking, Mapping and Inpainting in Dynamic Scenes", RA-L 2018; PATH_TO_MASKS in its
README. DynaSLAM dilates masks itself."""

BINARY = mask_format(
    "binary",
    "binary/<frame>.png, white where it moves, else black: editors, scripts",
    lambda frame: f"{Path(frame).stem}.png",
    Polarity(255, 0),
    0,
)
"""One mask for all that moves."""
