"""`moseg segment`."""

import sys
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from moseg.schemas.configs import Variant
from moseg.schemas.errors import InputError
from moseg.workflows.cli.correction_options import CorrectionOptions
from moseg.workflows.cli.export import ExportsOption, SetsOption, read_set_step
from moseg.workflows.cli.option_groups import with_option_groups
from moseg.workflows.cli.options import ReportOption, RunOptions, VariantOption
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.frame_range import FrameRange, read_frame_range
from moseg.workflows.config.frame_rate import MAX_FPS, MIN_FPS, check_fps

if TYPE_CHECKING:
    from moseg.workflows.api.segmentation import Segmented
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
    identities: Annotated[
        bool, typer.Option("--identities", help="The number, and the name, of each object on it.")
    ] = False
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


@dataclass(frozen=True)
class FrameOptions:
    """Which frames of the video are read."""

    PANEL: ClassVar[str] = "Frames"

    start: Annotated[
        str | None,
        typer.Option(
            "--start",
            help="First frame: a number from 0 (120), seconds (4.5s) or a timecode (0:04.5).",
            metavar="TIME",
        ),
    ] = None
    end: Annotated[
        str | None, typer.Option("--end", help="The frame before which to end, given likewise.", metavar="TIME")
    ] = None
    every: Annotated[
        str | None,
        typer.Option("--every", help="Only each n-th frame (5), or one in so many seconds (0.5s).", metavar="STEP"),
    ] = None
    fps: Annotated[
        float | None,
        typer.Option(
            "--fps",
            min=MIN_FPS,
            max=MAX_FPS,
            help="Frames per second of the video (default: its own; 24 for a folder).",
        ),
    ] = None

    def read(self) -> FrameRange:
        """Return the frames that these options choose; raises InputError where one cannot be read."""
        if self.fps is not None:
            check_fps(self.fps, "--fps")
        return read_frame_range(self.start, self.end, self.every)


@with_option_groups
def segment(
    videos: Annotated[
        list[str],
        typer.Argument(
            help="Video files, folders of frames, folders of videos, or - for standard input.", metavar="VIDEO…"
        ),
    ],
    frames: FrameOptions,
    pipeline: PipelineOptions,
    corrections: CorrectionOptions,
    run: RunOptions,
    drawing: OverlayOptions,
    out: Annotated[
        str,
        typer.Option(
            "--out",
            "-o",
            help="Folder for masks/, overlay.mp4 and motion.json; several videos each have one of their name in it.",
            metavar="FOLDER",
        ),
    ] = "out",
    variant: VariantOption = Variant.FUSED,
    exports: ExportsOption = None,
    sets: SetsOption = None,
    sets_every: Annotated[
        str | None,
        typer.Option(
            "--for-every",
            help="Of the frames, only each n-th (10) or one in so many seconds (0.5s) in the set of --for.",
            metavar="STEP",
        ),
    ] = None,
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
    moseg segment holiday.mp4 --out holiday --start 0:10 --end 0:20
    moseg segment clips/ more.mp4 --out all
    moseg segment frames/ --out walk --quality best --workers 2
    moseg segment holiday.mp4 --preset paper --device cuda
    moseg segment holiday.mp4 --overlay cutout --side-by-side --export coco
    moseg segment holiday.mp4 --out holiday --for colmap --for-every 0.5s
    moseg segment holiday.mp4 --out holiday --drop 2 --merge 3,4 --rename 1=car
    moseg segment holiday.mp4 --out holiday --corrections holiday/corrections.yaml
    """
    from moseg.workflows.api.segmentation import Outputs, open_source, run_segmentation
    from moseg.workflows.api.video_inputs import find_videos, opened
    from moseg.workflows.exports.formats import choose_formats
    from moseg.workflows.exports.frame_origin import FrameOrigin

    found = find_videos(videos)
    if corrections.given and len(found) > 1:
        got = f"{len(found)} videos"
        raise InputError("corrections of several videos", where=corrections.given[0], got=got, expected="one video")
    given = corrections.read()
    chosen, style, choices = frames.read(), drawing.read(), pipeline.choices()
    choices = replace(choices, corrected=given.corrections.settings)
    # Wrong options are an error of the call, and not of each video.
    choices.read()
    choose_formats(exports or ())
    step = read_set_step(sets, sets_every, "--for-every")
    settings = replace(run.settings(), keep_cues=keep_cues)

    def segment_one(video, folder: str) -> None:
        with opened(video) as path, open_source(path, choices, video.name, chosen, frames.fps) as (source, config):
            origin = FrameOrigin(path, source.frames)
            outputs = Outputs(
                folder,
                origin,
                style,
                source.name,
                drawing.overlay_size == "video",
                exports or (),
                sets=sets or (),
                step=step,
                fps=None if frames.fps is None else chosen.thinned_rate(frames.fps),
                corrections=given,
                page=page,
            )

            def write(store, stored, rate):
                return outputs.write(store, stored, rate, run.quiet)

            with outputs:
                done = run_segmentation(
                    source,
                    config,
                    variant,
                    settings,
                    write,
                    frames.fps,
                    page,
                    chosen=chosen,
                    corrections=given,
                    uncorrected=choices.read_uncorrected(),
                )
                exported = outputs.export()
        _print_outcome(done, [*(f"{folder}/{path.name}" for path in outputs.paths), *map(str, exported)], outputs.notes)

    if page is not None and len(found) > 1:
        raise InputError("one page for several videos", where="--report", got=f"{len(found)} videos", expected="one")
    failed = []
    for video in found:
        if not video.is_one_of_several:
            segment_one(video, out)
            continue
        try:
            segment_one(video, f"{out}/{video.name}")
        except InputError as error:
            # The others need not wait for one that cannot be read.
            print(f"moseg: {error}", file=sys.stderr)
            failed.append(video.path)
    if failed:
        got = ", ".join(failed)
        raise InputError(f"{len(failed)} of {len(found)} videos not segmented", got=got, expected="see above")


def _print_outcome(done: "Segmented", written: list[str], notes: tuple[str, ...]) -> None:
    count = len(done.value.objects)
    print(
        f"{count} moving object{'' if count == 1 else 's'} in {done.value.num_frames} frames: {', '.join(written)}"
        f" ({done.use.computed} artifacts computed, {done.use.reused} reused, {done.seconds:.1f} s)"
    )
    for note in (*done.notes, *notes):
        print(f"note: {note}")
    for doubt in done.value.look_at:
        print(f"look at: {doubt}")
    if done.page is not None:
        print(done.page)
