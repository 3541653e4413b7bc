"""`moseg export`."""

from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperOption

from moseg.schemas.errors import InputError
from moseg.workflows.cli.named_options import enumerate_names
from moseg.workflows.plugins.registered import entries

OWN_FORMATS = ("davis", "coco", "ytvis", "colmap", "nerfstudio", "instant-ngp", "dynaslam", "npz", "csv")
"""As the registry of formats has them, whose import takes OpenCV: a help text needs none."""

ExportsOption = Annotated[
    list[str] | None,
    typer.Option("--export", help="Also write for another program: {formats}; may be repeated."),
]


def format_names() -> tuple[str, ...]:
    """Return the names of the export formats, those of plug-ins among them."""
    return OWN_FORMATS + tuple(entry.declared.name for entry in entries if hasattr(entry.declared, "last_identity"))


def fill_in_formats(option: TyperOption) -> None:
    """Write the names of the export formats into the help of an option that has ``{formats}``."""
    if option.help is not None and "{formats}" in option.help:
        option.help = option.help.replace("{formats}", enumerate_names(format_names()))


def export(
    folder: Annotated[str, typer.Argument(help="What `moseg segment --out` left: masks/ and motion.json.")],
    to: Annotated[list[str] | None, typer.Option("--to", help="Format: {formats}; may be repeated.")] = None,
    out: Annotated[str | None, typer.Option("--out", "-o", help="Folder to write in (default: the same).")] = None,
    images: Annotated[
        str | None,
        typer.Option(
            "--images", help="Folder of the frames, whose file names count (default: those that were segmented)."
        ),
    ] = None,
    name: Annotated[str | None, typer.Option("--name", help="Name of the sequence (default: the video's).")] = None,
    dilate: Annotated[
        int | None,
        typer.Option(
            "--dilate",
            min=0,
            help="Widen what is to be ignored, px (default: 5; 0 for dynaslam, which widens it too).",
        ),
    ] = None,
) -> None:
    """Write finished masks for other programs; needs no store.

    Examples
    --------
    moseg export holiday --to colmap --images holiday-frames
    """
    from moseg.workflows.exports import check_folder
    from moseg.workflows.exports.formats import choose_formats
    from moseg.workflows.exports.formats import export as export_saved
    from moseg.workflows.exports.saved_segmentation import open_segmentation

    if not to:
        raise InputError("no format named", where="--to", expected=enumerate_names(format_names()))
    formats = choose_formats(to, dilate)
    saved = open_segmentation(Path(folder), None if images is None else Path(images), name)
    target = Path(folder if out is None else out)
    check_folder(target)
    written = export_saved(saved, formats, target, dilate)
    print(f"{saved.summary.num_frames} frames: {', '.join(map(str, written))}")
