"""`moseg segment`."""

from pathlib import Path
from typing import Annotated

import typer

from moseg.schemas.configs import Variant
from moseg.schemas.errors import InputError
from moseg.workflows.cli.export_options import ExportsOption
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import ReportOption, RunOptions
from moseg.workflows.cli.overlay_options import OverlayOptions
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.notes import motions_note
from moseg.workflows.sources.frames import MAX_FPS, MIN_FPS, check_fps, choose_fps


@with_option_groups
def segment(
    video: Annotated[str, typer.Argument(help="A video file, or a folder of frames.")],
    pipeline: PipelineOptions,
    run: RunOptions,
    drawing: OverlayOptions,
    out: Annotated[
        str, typer.Option("--out", help="Folder for masks/, overlay.mp4 and motion.json.", metavar="FOLDER")
    ] = "out",
    variant: Annotated[
        Variant,
        typer.Option(
            "--variant", help="Row of the paper's ablation: fused, oc-depth, oc, trajs or base.", metavar="NAME"
        ),
    ] = Variant.FUSED,
    fps: Annotated[
        float | None,
        typer.Option(
            "--fps",
            min=MIN_FPS,
            max=MAX_FPS,
            help="Frames per second of overlay.mp4 and motion.json (default: the video's own; 24 for a folder).",
        ),
    ] = None,
    exports: ExportsOption = None,
    page: ReportOption = None,
) -> None:
    """Masks of what moves on its own in your video: OUT/masks/*.png, OUT/overlay.mp4, OUT/motion.json.

    Examples
    --------
    moseg segment holiday.mp4 --out holiday
    moseg segment frames/ --out holiday --quality best --workers 2
    moseg segment holiday.mp4 --preset paper --device cuda
    moseg segment holiday.mp4 --overlay cutout --side-by-side --export coco
    """
    from moseg.workflows.datasets import SequenceSource
    from moseg.workflows.datasets.given_folders import with_given_folders
    from moseg.workflows.exports.formats import check_exports, choose_formats
    from moseg.workflows.exports.formats import export as export_saved
    from moseg.workflows.exports.motion_json import frame_names
    from moseg.workflows.exports.outputs import MASKS, MOTION, OVERLAY, check_outputs, mask_name
    from moseg.workflows.exports.saved_segmentation import open_segmentation
    from moseg.workflows.pipelines.purpose import Purpose
    from moseg.workflows.pipelines.segment import segment as run_segmentation
    from moseg.workflows.pipelines.write_segmentation import write_segmentation
    from moseg.workflows.reports.run_report import RunReport
    from moseg.workflows.runlog.events import as_unicode
    from moseg.workflows.sources import open_frames

    if not video.strip():
        raise InputError("no video named", got=repr(video), expected="a video file, or a folder of frames")
    if pipeline.motions == "gt":
        raise InputError("no ground truth of your own video", where="--motions", got="gt", expected="auto or a number")
    if fps is not None:
        check_fps(fps, "--fps")
    style = drawing.read()
    check_outputs(out, video, style is not None)
    config, folders = pipeline.read()
    frames = open_frames(video, config.max_side)
    given_names = frame_names(frames)
    formats = choose_formats(exports or (), frames=given_names)
    source = with_given_folders(SequenceSource(Path(video).resolve().stem, frames), folders, config.max_side)
    if formats:
        names = given_names or tuple(mask_name(index) for index in range(frames.num_frames()))
        check_exports(formats, Path(out), as_unicode(source.name), names)
    shown = None if page is None else RunReport(page, source.name, config, [variant], [source.name])
    rate = choose_fps(fps, frames.describe().fps)
    panels = None if shown is None else shown.panels
    with run.open() as session:

        def export(result):
            full = drawing.full_frames(frames)
            summary = write_segmentation(Path(out), session.store, result, rate, style, full, given_names, run.quiet)
            return result, summary

        purpose = Purpose("segment", motions_note(config), rate)
        result, summary = run_segmentation(session, source, config, variant, export, purpose, panels)
        if shown is not None:
            shown.note_facts(session)
    exported = export_saved(open_segmentation(Path(out)), formats, Path(out)) if formats else ()
    count = len(summary.objects)
    objects = f"{count} moving object{'' if count == 1 else 's'}"
    use = session.use()
    outputs = (MASKS, MOTION) if style is None else (MASKS, OVERLAY, MOTION)
    written = ", ".join((*(f"{out}/{name}" for name in outputs), *map(str, exported)))
    print(
        f"{objects} in {result.num_frames} frames: {written}"
        f" ({use.computed} artifacts computed, {use.reused} reused, {session.seconds:.1f} s)"
    )
    for note in motions_note(config):
        print(f"note: {note}")
    if shown is not None:
        print(shown.write((), motions_note(config)))
