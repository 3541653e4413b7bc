"""Palette masks in the folders of DAVIS and YouTube-VOS."""

from pathlib import Path

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation
from moseg.workflows.exports.write_masks import LAST_PALETTE_IDENTITY, write_mask


def write_davis(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``davis/<sequence>/<frame>.png``, the value of a pixel its identity, and return the folder.

    References
    ----------
    Pont-Tuset et al., "The 2017 DAVIS Challenge on Video Object Segmentation", 2017.
    """
    target = davis_folder(folder, saved.summary.name, saved.names)
    with target:
        for name, labels in zip(target.names, saved.labels(), strict=True):
            write_mask(target.folder / name, labels)
    return target.folder


def davis_folder(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFolder:
    """Return the folder that `write_davis` writes, with the names in it."""
    return OwnedFolder(folder / "davis" / sequence, (f"{Path(name).stem}.png" for name in names))


DAVIS = ExportFormat(
    "davis",
    "davis/<sequence>/<frame>.png with a palette: DAVIS and YouTube-VOS evaluation, moseg score",
    write_davis,
    davis_folder,
    last_identity=LAST_PALETTE_IDENTITY,
)
