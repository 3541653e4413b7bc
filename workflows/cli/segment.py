"""`moseg segment`."""

from typing import Annotated

import typer

from moseg.schemas.configs import Variant
from moseg.workflows.cli.export_options import ExportsOption
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import ReportOption, RunOptions, VariantOption
from moseg.workflows.cli.overlay_options import OverlayOptions
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.frame_rate import FASTEST_FPS, SLOWEST_FPS, check_fps


@with_option_groups
def segment(
    video: Annotated[str, typer.Argument(help="A video file, or a folder of frames.")],
    pipeline: PipelineOptions,
    run: RunOptions,
    drawing: OverlayOptions,
    out: Annotated[
        str, typer.Option("--out", help="Folder for masks/, overlay.mp4 and motion.json.", metavar="FOLDER")
    ] = "out",
    variant: VariantOption = Variant.FUSED,
    fps: Annotated[
        float | None,
        typer.Option(
            "--fps",
            min=SLOWEST_FPS,
            max=FASTEST_FPS,
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
    from moseg.workflows.api.segmentation import Outputs, open_source, run_segmentation
    from moseg.workflows.exports.motion_json import frame_names

    if fps is not None:
        check_fps(fps, "--fps")
    style = drawing.read()
    with open_source(video, pipeline.choices()) as (source, config):
        frames, has_full_size = source.frames, drawing.overlay_size == "video"
        outputs = Outputs(
            out, video, style, source.name, frame_names(frames), frames.num_frames, has_full_size, exports or ()
        )

        def write(store, stored, rate):
            return outputs.write(store, stored, rate, run.quiet)

        done = run_segmentation(source, config, variant, run.settings(), write, fps, page)
    exported = outputs.export()
    count = len(done.value.objects)
    written = ", ".join((*(f"{out}/{path.name}" for path in outputs.paths), *map(str, exported)))
    print(
        f"{count} moving object{'' if count == 1 else 's'} in {done.value.num_frames} frames: {written}"
        f" ({done.use.computed} artifacts computed, {done.use.reused} reused, {done.seconds:.1f} s)"
    )
    for note in done.notes:
        print(f"note: {note}")
    if done.page is not None:
        print(done.page)
