"""`moseg export`."""

from typing import TYPE_CHECKING, Annotated

import typer
from typer.core import TyperOption

from moseg.schemas.errors import InputError
from moseg.workflows.cli.named_options import enumerate_names
from moseg.workflows.config.frame_range import read_step
from moseg.workflows.plugins.registered import entries

if TYPE_CHECKING:
    from moseg.workflows.config.frame_range import Position

OWN_FORMATS = (
    *("davis", "coco", "ytvis", "colmap", "nerfstudio", "instant-ngp", "dynaslam", "npz", "csv"),
    *("binary", "matte", "prores", "webm"),
)
OWN_SETS = ("colmap", "nerfstudio")
"""As the registries of formats and of sets have them, whose import takes OpenCV: a help text needs none."""

ExportsOption = Annotated[
    list[str] | None,
    typer.Option("--export", help="Also write for another program: {formats}; may be repeated."),
]
SetsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--for",
        help=f"Also write frames and masks, whose names match, for a program: {enumerate_names(OWN_SETS)}; may be"
        " repeated.",
        metavar="PROGRAM",
    ),
]


def read_set_step(sets: list[str] | None, every: str | None, option: str) -> "Position | None":
    """Return the step of the frames of a set; raises InputError on one without a set, or that cannot be read."""
    if every is None:
        return None
    if not sets:
        raise InputError("an option without effect", where=option, got="no --for", expected="--for PROGRAM")
    return read_step(every, option)


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
    sets: SetsOption = None,
    video: Annotated[
        str | None,
        typer.Option(
            "--video", help="The video, or the folder of frames: for --for, and formats with frames.", metavar="VIDEO"
        ),
    ] = None,
    every: Annotated[
        str | None,
        typer.Option(
            "--every",
            help="Of the frames, only each n-th (10) or one in so many seconds (0.5s), with --for.",
            metavar="STEP",
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
    moseg export holiday --for colmap --video holiday.mp4 --every 0.5s
    """
    from moseg.workflows.api.saved_exports import export_saved

    if not to and not sets:
        raise InputError("no format named", where="--to", expected=enumerate_names(format_names()))
    step = read_set_step(sets, every, "--every")
    num_frames, written = export_saved(folder, out, to or (), sets or (), images, video, step, name, dilate)
    print(f"{num_frames} frames: {', '.join(map(str, written))}")
