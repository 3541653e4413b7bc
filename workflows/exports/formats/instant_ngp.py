"""Masks for instant-ngp's training."""

from pathlib import Path

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.ignore_masks import DEFAULT_DILATION, Polarity, write_ignore_masks
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.saved_segmentation import SavedSegmentation


def write_instant_ngp(saved: SavedSegmentation, folder: Path, dilation: int | None = None) -> Path:
    """Write ``instant-ngp/dynamic_mask_<frame>.png``, non-zero where pixels are masked away.

    References
    ----------
    instant-ngp's README, "How to mask away NeRF training pixels (e.g. for dynamic object removal)?".
    """
    target = instant_ngp_folder(folder, saved.summary.name, saved.names)
    widened = DEFAULT_DILATION if dilation is None else dilation
    return write_ignore_masks(target, saved, Polarity(255, 0), widened)


def instant_ngp_folder(folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFolder:
    """The folder that `write_instant_ngp` writes, and the names in it."""
    return OwnedFolder(folder / "instant-ngp", (f"dynamic_mask_{Path(name).stem}.png" for name in names))


INSTANT_NGP = ExportFormat(
    "instant-ngp",
    "instant-ngp/dynamic_mask_<frame>.png, white where it moves: beside instant-ngp's images",
    write_instant_ngp,
    instant_ngp_folder,
    True,
)
