"""Frames and masks for reconstruction as one set: files whose names match, of all frames or of thinned ones."""

import shutil
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.schemas.spelling import unknown_name
from moseg.workflows.config.frame_range import FrameRange, Position
from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.formats.ignore_masks import DEFAULT_DILATION, dilate_moving
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation, required_origin
from moseg.workflows.process.atomic_write import atomic_path, blame_output
from moseg.workflows.sources import ImageFiles
from moseg.workflows.sources.files import read_bytes
from moseg.workflows.sources.image_files import decode_image
from moseg.workflows.sources.pillow_image import PILLOW_ERRORS, open_quietly

IMAGES, MASKS = "images", "masks"
JPEG_QUALITY = 95
"""Of photographs that are written anew because they were turned; Pillow advises against more."""
# Exif 2.32, 4.6: tags of the orientation, of Exif's own part with its pixel sizes, and of those of the first part.
_EXIF_ORIENTATION, _EXIF_PART = 0x0112, 0x8769
_EXIF_SIZES, _TIFF_SIZES = (0xA002, 0xA003), (0x0100, 0x0101)
_ABOUT_A_TIFF = (0x010F, 0x0110, 0x0131, 0x0132, _EXIF_PART, 0x8825)
"""Tags of a TIFF that do not describe how its pixels are stored: maker, model, software, time, Exif's part and GPS."""


class SetFolders(NamedTuple):
    """The two folders of a set, in which files are written."""

    images: OwnedFolder
    masks: OwnedFolder

    def check(self) -> None:
        """Raise InputError where they cannot be written, or would replace a file that moseg did not write."""
        self.images.check()
        self.masks.check()

    def earlier(self) -> Path | None:
        """Return the folder of both if an earlier export wrote files in one of them."""
        return self.images.folder.parent if self.images.earlier() or self.masks.earlier() else None


def write_set(
    name: str,
    image_name: Callable[[int, str], str],
    mask_name: Callable[[str], str],
    saved: SavedSegmentation,
    folder: Path,
    dilation: int | None = None,
) -> Path:
    """Write ``for-<name>/images`` and ``for-<name>/masks``, black where it moves, and return their folder.

    The image files of a folder of frames are copied, unless they are photographs that EXIF turns: these are written
    upright, because masks are upright and not all programs turn images. They keep their other EXIF data, such as the
    focal length, and their colour profile. Frames of a video are written as PNG.
    """
    target = set_folders(name, image_name, mask_name, folder, saved.summary.name, saved.names)
    width = DEFAULT_DILATION if dilation is None else dilation
    with target.images as images, target.masks as masks:
        for file, write in zip_longest(images.names, _frame_writers(saved)):
            if file is None or write is None:
                raise InputError("masks and frames differ in number", where=required_origin(saved.origin).path)
            with atomic_path(images.folder / file) as temporary, blame_output(images.folder / file):
                write(temporary)
        for file, labels in zip(masks.names, saved.labels(), strict=True):
            mask = Image.fromarray(np.where(dilate_moving(labels, width), 0, 255).astype(np.uint8))
            with atomic_path(masks.folder / file) as temporary, blame_output(masks.folder / file):
                mask.save(temporary, format="PNG")
    return images.folder.parent


def set_folders(
    name: str,
    image_name: Callable[[int, str], str],
    mask_name: Callable[[str], str],
    folder: Path,
    sequence: str,
    names: tuple[str, ...],
) -> SetFolders:
    """Return the folders that `write_set` writes, with the names in them."""
    root = Path(folder) / f"for-{name}"
    files = [image_name(index, frame) for index, frame in enumerate(names)]
    # Programs take every file beside the images for an image.
    images = OwnedFolder(root / IMAGES, files, listing=root / ".moseg-images.json")
    return SetFolders(images, OwnedFolder(root / MASKS, map(mask_name, files), listing=root / ".moseg-masks.json"))


def _frame_writers(saved: SavedSegmentation) -> Iterator[Callable[[Path], object]]:
    """Yield a function of a path for each frame, which writes its image there."""
    origin = required_origin(saved.origin).choose(saved.kept)
    if not isinstance(origin.frames, ImageFiles):
        for image in saved.frames():
            yield partial(Image.fromarray(image).save, format="PNG")
        return
    size = (saved.summary.width, saved.summary.height)
    for path in origin.frames.paths:
        try:
            with open_quietly(Path(path)) as image:
                found, kind = image.size, image.format
                orientation = image.getexif().get(_EXIF_ORIENTATION, 1)
                about = _about_upright(image) if orientation in range(2, 9) else {}
        except PILLOW_ERRORS as error:
            raise InputError("image cannot be decoded", where=path) from error
        # Pillow gives the size of a TIFF as after it was turned.
        if (found[::-1] if orientation in range(5, 9) and kind != "TIFF" else found) != size:
            expected = f"{size[0]}x{size[1]} px, as in motion.json"
            raise InputError("image of the wrong size", where=path, got=f"{found[0]}x{found[1]} px", expected=expected)
        if orientation in range(2, 9):
            upright = Image.fromarray(decode_image(read_bytes(path), path))
            yield partial(upright.save, format=kind, quality=JPEG_QUALITY, **about)
        else:
            yield partial(shutil.copyfile, path)


def _about_upright(image: Image.Image) -> dict[str, bytes]:
    """Return the EXIF data of a photograph as after it was turned upright, and its colour profile if that is of RGB."""
    exif = image.getexif()
    orientation = exif.pop(_EXIF_ORIENTATION)
    part = exif.get_ifd(_EXIF_PART)
    if image.format == "TIFF":
        for tag in set(exif).difference(_ABOUT_A_TIFF):
            del exif[tag]
    if orientation in range(5, 9):
        for tags, (width, height) in ((exif, _TIFF_SIZES), (part, _EXIF_SIZES)):
            if width in tags and height in tags:
                tags[width], tags[height] = tags[height], tags[width]
    about = {"exif": exif.tobytes()}
    profile = image.info.get("icc_profile")
    return about | {"icc_profile": profile} if profile and image.mode in ("RGB", "RGBA") else about


def choose_kept(
    origin: FrameOrigin, num_frames: int, step: Position | None, fps: float | None
) -> tuple[int, ...] | None:
    """Return which frames of a segmentation a set has, counted from 0; None for all.

    Parameters
    ----------
    origin : FrameOrigin
    num_frames : int
    step : Position or None
        Each n-th frame, or one in so many seconds.
    fps : float or None
        Frames per second of images, which have no times of their own.

    Raises
    ------
    InputError
        A time is given, and images have no rate.
    """
    if step is None:
        return None
    times: Iterable[float] = range(num_frames)
    if step.is_time:
        if fps is None and isinstance(origin.frames, ImageFiles):
            raise InputError("a time needs a frame rate", where=origin.path, got="frames without one", expected="--fps")
        times = origin.times(fps or 1)
    return tuple(FrameRange(every=step).choose(times))


def choose_sets(names: Iterable[str]) -> tuple[ExportFormat, ...]:
    """Return the sets for the programs named, each once; raises InputError where there is none."""
    names = tuple(dict.fromkeys(names))
    for name in names:
        if name not in SETS:
            raise unknown_name("program to reconstruct with", name, SETS)
    return tuple(SETS[name] for name in names)


def _set_format(name: str, image_name: Callable[[int, str], str], mask_name: Callable[[str], str]) -> ExportFormat:
    return ExportFormat(
        name,
        f"for-{name}/images and for-{name}/masks, whose names match: {name}",
        partial(write_set, name, image_name, mask_name),
        partial(set_folders, name, image_name, mask_name),
        is_dilated=True,
        needs_frames=True,
    )


COLMAP_SET = _set_format("colmap", lambda index, frame: frame, lambda image: f"{image}.png")
"""COLMAP's documentation, "Frequently Asked Questions", section "Mask image regions"."""
NERFSTUDIO_SET = _set_format(
    "nerfstudio",
    lambda index, frame: f"frame_{index + 1:05d}{Path(frame).suffix.lower()}",
    lambda image: f"{Path(image).stem}.png",
)
"""Names that ``ns-process-data images`` gives, so that its copies of the images still have the masks' names."""
SETS = {entry.name: entry for entry in (COLMAP_SET, NERFSTUDIO_SET)}
