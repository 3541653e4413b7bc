"""Formats in which a segmentation is exported, by name."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.schemas.spelling import unknown_name
from moseg.workflows.exports.formats.annotations import COCO, YTVIS
from moseg.workflows.exports.formats.davis import DAVIS
from moseg.workflows.exports.formats.editor_videos import MATTE, PRORES, WEBM
from moseg.workflows.exports.formats.export_format import ExportFormat, KnownTarget
from moseg.workflows.exports.formats.ignore_masks import BINARY, COLMAP, DYNASLAM, INSTANT_NGP, NERFSTUDIO
from moseg.workflows.exports.formats.npz import NPZ
from moseg.workflows.exports.formats.object_table import CSV
from moseg.workflows.exports.motion_json import check_file_name
from moseg.workflows.exports.saved_segmentation import SavedSegmentation, required_origin

FORMATS = {
    entry.name: entry
    for entry in (DAVIS, COCO, YTVIS, COLMAP, NERFSTUDIO, INSTANT_NGP, DYNASLAM, NPZ, CSV, BINARY, MATTE, PRORES, WEBM)
}


def choose_formats(
    names: Iterable[str], dilation: int | None = None, frames: tuple[str, ...] | None = None
) -> tuple[ExportFormat, ...]:
    """Return the formats named, each once.

    Parameters
    ----------
    names : iterable of str
    dilation : int, optional
        Px, to be used with at least one of them.
    frames : tuple of str, optional
        File names of the frames, where they are known before the work: each format must accept them.

    Raises
    ------
    InputError
        No format has the name, none is dilated where a dilation is given, one does not accept the frames' names, or its
        encoder is missing.
    """
    names = tuple(dict.fromkeys(names))
    for name in names:
        if name not in FORMATS:
            raise unknown_name("export format", name, FORMATS)
    chosen = tuple(FORMATS[name] for name in names)
    if dilation is not None and not any(entry.is_dilated for entry in chosen):
        expected = " or ".join(entry.name for entry in FORMATS.values() if entry.is_dilated)
        got = ", ".join(names) or "no format"
        raise InputError("nothing to dilate", where="--dilate", got=got, expected=f"one of {expected}")
    for entry in chosen:
        if frames is not None and entry.check_names is not None:
            entry.check_names(frames)
        if entry.check_encoder is not None:
            entry.check_encoder()
    return chosen


def export(
    saved: SavedSegmentation, formats: Iterable[ExportFormat], folder: Path, dilation: int | None = None
) -> tuple[Path, ...]:
    """Write a segmentation in some formats into a folder, after a check that all can be written.

    Returns
    -------
    tuple of Path
        The files and folders written.

    Raises
    ------
    InputError
        `check_exports` fails, a format cannot hold an object, or a file cannot be read or written.
    """
    formats, folder = tuple(formats), Path(folder)
    check_exports(formats, folder, saved.summary.name, saved.names)
    last = max((entry.identity for entry in saved.summary.objects), default=0)
    for entry in formats:
        if entry.needs_frames:
            required_origin(saved.origin, entry.name)
        if entry.last_identity is not None and last > entry.last_identity:
            expected = f"at most {entry.last_identity}"
            raise InputError("too many objects for a palette", where=entry.name, got=last, expected=expected)
    return tuple(entry.write(saved, folder, dilation) for entry in formats)


def earlier_exports(formats: Iterable[ExportFormat], folder: Path, sequence: str) -> tuple[Path, ...]:
    """Return what earlier runs wrote into a folder in some formats, as far as their targets know."""
    found = []
    for entry in formats:
        target = entry.target(Path(folder), sequence, ())
        # A listing that cannot be read is no concern of a run that does not write the format.
        with suppress(InputError):
            if isinstance(target, KnownTarget) and (path := target.earlier()) is not None:
                found.append(path)
    return tuple(found)


def check_exports(formats: Iterable[ExportFormat], folder: Path, sequence: str, names: tuple[str, ...]) -> None:
    """Check before the work that formats can be written into a folder, without writing.

    Parameters
    ----------
    formats : iterable of ExportFormat
    folder : Path
    sequence : str
        Its name.
    names : tuple of str
        File names of the frames, as a `SavedSegmentation` has them.

    Raises
    ------
    InputError
        A name is not that of a file, two frames share a name, or a file would be replaced that moseg did not write.
    """
    for entry in formats:
        check_file_name(sequence, "sequence", folder)
        entry.target(Path(folder), sequence, names).check()
