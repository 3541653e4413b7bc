"""`moseg segment`."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from moseg.schemas.configs import Variant
from moseg.schemas.errors import InputError
from moseg.workflows.cli.export import ExportsOption
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import ReportOption, RunOptions, VariantOption
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.frame_rate import MAX_FPS, MIN_FPS, check_fps

if TYPE_CHECKING:
    from moseg.workflows.exports import OverlayStyle


@dataclass(frozen=True)
class OverlayOptions:
    """How ``overlay.mp4`` is drawn."""

    PANEL: ClassVar[str] = "Overlay video"

    overlay: Annotated[
        Literal["outline", "fill", "contour", "mask", "cutout", "none"],
        typer.Option(
            "--overlay",
            help="Overlay: tint and outline, tint alone (fill), line alone (contour), colours on black (mask), all else"
            " in dim grey (cutout), or no video (none).",
            metavar="NAME",
        ),
    ] = "outline"
    opacity: Annotated[
        float | None,
        typer.Option("--opacity", min=0, max=1, help="Strength of the tint, 0 to 1 (default: 0.45)."),
    ] = None
    outline_width: Annotated[
        int | None, typer.Option("--outline-width", min=1, max=64, help="Width of the outline, px (default: 2).")
    ] = None
    side_by_side: Annotated[
        bool, typer.Option("--side-by-side", help="The untouched frame at the left, the overlay at the right.")
    ] = False
    identities: Annotated[bool, typer.Option("--identities", help="The number of each object on it.")] = False
    overlay_size: Annotated[
        Literal["analysed", "video"],
        typer.Option(
            "--overlay-size",
            help="Size of the overlay: that of the frames as analysed, or the video's own.",
            metavar="NAME",
        ),
    ] = "analysed"

    def read(self) -> "OverlayStyle | None":
        """Return the style, None for no overlay; raises InputError on an option that has no effect on the overlay."""
        from moseg.workflows.exports import OverlayMode, OverlayStyle
        from moseg.workflows.exports.overlay_style import LINED, TINTED

        mode = None if self.overlay == "none" else OverlayMode(self.overlay)
        given = (
            ("--opacity", self.opacity is not None, TINTED),
            ("--outline-width", self.outline_width is not None, LINED),
            ("--side-by-side", self.side_by_side, OverlayMode),
            ("--identities", self.identities, OverlayMode),
            ("--overlay-size", self.overlay_size == "video", OverlayMode),
        )
        for option, is_given, modes in given:
            if is_given and mode not in (*modes,):
                expected = f"--overlay {' or '.join(modes)}"
                raise InputError(
                    "an option without effect", where=option, got=f"--overlay {self.overlay}", expected=expected
                )
        if mode is None:
            return None
        chosen = {"opacity": self.opacity, "outline_width": self.outline_width}
        return OverlayStyle(
            mode=mode,
            is_side_by_side=self.side_by_side,
            has_identities=self.identities,
            **{name: value for name, value in chosen.items() if value is not None},
        )


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
            min=MIN_FPS,
            max=MAX_FPS,
            help="Frames per second of overlay.mp4 and motion.json (default: the video's own; 24 for a folder).",
        ),
    ] = None,
    exports: ExportsOption = None,
    page: ReportOption = None,
    keep_cues: Annotated[
        bool,
        typer.Option("--keep-cues", help="Keep flow and saliency in the store, to try other settings sooner."),
    ] = False,
) -> None:
    """Write masks of what moves on its own in your video: OUT/masks/*.png, OUT/overlay.mp4, OUT/motion.json.

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

        done = run_segmentation(source, config, variant, replace(run.settings(), keep_cues=keep_cues), write, fps, page)
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
