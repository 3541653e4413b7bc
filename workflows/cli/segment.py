"""`moseg segment`."""

import math
from pathlib import Path
from typing import Annotated

import typer

from schemas.configs import Variant
from schemas.errors import InputError
from workflows.cli.notes import motions_note
from workflows.cli.options import PipelineOptions, RunOptions, with_option_groups


@with_option_groups
def segment(
    video: Annotated[str, typer.Argument(help="A video file, or a folder of frames.")],
    pipeline: PipelineOptions,
    run: RunOptions,
    out: Annotated[str, typer.Option("--out", help="Folder for masks/, overlay.mp4 and motion.json.")] = "out",
    variant: Annotated[Variant, typer.Option("--variant", help="Row of the paper's ablation to run.")] = Variant.FUSED,
    fps: Annotated[
        float, typer.Option("--fps", min=0.1, help="Frame rate of the overlay of a folder of frames.")
    ] = 24.0,
) -> None:
    """Masks of what moves on its own in your video: OUT/masks/*.png, OUT/overlay.mp4, OUT/motion.json.

    Example: moseg segment holiday.mp4 --out holiday
    """
    from workflows.datasets import SequenceSource
    from workflows.exports import check_folder
    from workflows.exports.write_segmentation import write_segmentation
    from workflows.given_folders import with_given_folders
    from workflows.segment import segment as run_segmentation
    from workflows.sources import open_frames

    if not video.strip():
        raise InputError("no video named", got=repr(video), expected="a video file, or a folder of frames")
    if pipeline.motions == "gt":
        raise InputError("no ground truth of your own video", where="--motions", got="gt", expected="auto or a number")
    if not math.isfinite(fps):
        raise InputError("not a frame rate", where="--fps", got=fps, expected="frames per second")
    check_folder(Path(out))
    config, folders = pipeline.read()
    frames = open_frames(video, config.max_side)
    source = with_given_folders(SequenceSource(Path(video).resolve().stem, frames), folders, config.max_side)
    with run.open() as session:

        def export(result):
            return result, write_segmentation(Path(out), session.store, result, frames.describe().fps or fps)

        result, summary = run_segmentation(session, source, config, variant, export)
    count = len(summary.objects)
    objects = f"{count} moving object{'' if count == 1 else 's'}"
    use = session.use()
    print(
        f"{objects} in {result.num_frames} frames: {out}/masks, {out}/overlay.mp4, {out}/motion.json"
        f" ({use.computed} artifacts computed, {use.reused} reused, {session.seconds:.1f} s)"
    )
    for note in motions_note(config):
        print(f"note: {note}")
