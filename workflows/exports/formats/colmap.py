"""Masks for COLMAP's feature extraction."""

from pathlib import Path

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.ignore_masks import BLACK_IS_IGNORED, DEFAULT_DILATION, write_ignore_masks
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation


def write_colmap(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``colmap/<file name of the frame>.png``: black where no feature may be found, white elsewhere.

    References
    ----------
    COLMAP's documentation, "Frequently Asked Questions", section "Mask image regions".
    """
    target = colmap_folder(folder, saved.summary.name, saved.names)
    widened = DEFAULT_DILATION if dilation is None else dilation
    return write_ignore_masks(target, saved, BLACK_IS_IGNORED, widened)


def colmap_folder(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFolder:
    """The folder that `write_colmap` writes, and the names in it."""
    return OwnedFolder(folder / "colmap", (f"{name}.png" for name in names))


COLMAP = ExportFormat(
    "colmap",
    "colmap/<frame file>.png, black where it moves: COLMAP's --ImageReader.mask_path",
    write_colmap,
    colmap_folder,
    True,
)
