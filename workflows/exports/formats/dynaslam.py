"""Masks for DynaSLAM, in place of those of its own network."""

from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.ignore_masks import Polarity, write_ignore_masks
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation


def write_dynaslam(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``dynaslam/<file name of the frame>``: 1 where it moves, 0 elsewhere.

    DynaSLAM widens them itself.

    Raises
    ------
    InputError
        Frames that are no PNG: a mask has its frame's very name.

    References
    ----------
    Bescos et al., "DynaSLAM: Tracking, Mapping and Inpainting in Dynamic Scenes", RA-L 2018; PATH_TO_MASKS in its
    README.
    """
    check_names(saved.names)
    target = dynaslam_folder(folder, saved.summary.name, saved.names)
    return write_ignore_masks(target, saved, Polarity(1, 0), dilation or 0)


def dynaslam_folder(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFolder:
    """The folder that `write_dynaslam` writes, and the names in it."""
    return OwnedFolder(folder / "dynaslam", names)


def check_names(names: tuple[str, ...]) -> None:
    """Raise InputError where a frame is no PNG file."""
    for name in names:
        if not name.lower().endswith(".png"):
            raise InputError("not a PNG file", where="dynaslam", got=name, expected="frames whose names end in .png")


DYNASLAM = ExportFormat(
    "dynaslam",
    "dynaslam/<frame file>, 1 where it moves: PATH_TO_MASKS of DynaSLAM",
    write_dynaslam,
    dynaslam_folder,
    True,
    check_names,
)
