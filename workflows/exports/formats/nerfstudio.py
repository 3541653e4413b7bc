"""Masks for nerfstudio's training."""

from pathlib import Path

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.ignore_masks import BLACK_IS_IGNORED, DEFAULT_DILATION, write_ignore_masks
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation


def write_nerfstudio(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``nerfstudio/<frame>.png``, black where no ray is trained on; ``mask_path`` in transforms.json names them.

    References
    ----------
    nerfstudio's documentation, "Data conventions", section "Masks".
    """
    target = nerfstudio_folder(folder, saved.summary.name, saved.names)
    widened = DEFAULT_DILATION if dilation is None else dilation
    return write_ignore_masks(target, saved, BLACK_IS_IGNORED, widened)


def nerfstudio_folder(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFolder:
    """The folder that `write_nerfstudio` writes, and the names in it."""
    return OwnedFolder(folder / "nerfstudio", (f"{Path(name).stem}.png" for name in names))


NERFSTUDIO = ExportFormat(
    "nerfstudio",
    "nerfstudio/<frame>.png, black where it moves: mask_path of transforms.json",
    write_nerfstudio,
    nerfstudio_folder,
    True,
)
