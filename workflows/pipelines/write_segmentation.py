"""The files that `moseg segment` writes: masks, overlay video and summary of the motions of one video."""

from pathlib import Path

from moseg.store import ArtifactStore
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import SequenceSummary, write_motion
from moseg.workflows.exports.outputs import MASKS, MOTION, OVERLAY
from moseg.workflows.exports.overlay_style import DEFAULT_STYLE, OverlayStyle
from moseg.workflows.exports.ownership import is_own_overlay
from moseg.workflows.exports.summarise import summarise_sequence
from moseg.workflows.exports.write_masks import write_masks
from moseg.workflows.exports.write_overlay import write_overlay
from moseg.workflows.pipelines.segment import StoredSegmentation
from moseg.workflows.process.atomic_write import blame_output, sweep_leftovers
from moseg.workflows.process.progress import PATIENCE_SEC, StageProgress


def write_segmentation(
    folder: Path,
    store: ArtifactStore,
    result: StoredSegmentation,
    fps: float,
    style: OverlayStyle | None = DEFAULT_STYLE,
    origin: FrameOrigin | None = None,
    has_full_size: bool = False,
    quiet: bool = True,
) -> SequenceSummary:
    """Write ``masks/00000.png`` … and ``motion.json`` at the video's own size, and ``overlay.mp4``.

    ``motion.json`` is written last, and that of an earlier run is removed first: where it is present, all files are
    there and of one run.

    Parameters
    ----------
    folder : Path
        One that `check_outputs` has let pass: files of these names in it are replaced.
    store : ArtifactStore
    result : StoredSegmentation
    fps : float
        Frames per second.
    style : OverlayStyle, optional
        Of the overlay; where None there is none, and one that an earlier run left is removed.
    origin : FrameOrigin, optional
        Where the frames come from, for the summary.
    has_full_size : bool
        Whether the overlay has the video's own size, for which the frames of `origin` are read again, or the size
        analysed.
    quiet : bool
        No progress on standard error.

    Returns
    -------
    SequenceSummary
        What ``motion.json`` holds.

    Raises
    ------
    InputError
        Where the folder cannot be written.
    """
    folder = Path(folder)
    stages = ("masks", "overlay", "summary") if style is not None else ("masks", "summary")
    totals = dict.fromkeys(stages, result.num_frames)
    progress = StageProgress(totals, quiet, "frames written", PATIENCE_SEC)
    with sweep_leftovers(folder), progress:
        with blame_output(folder / MOTION):
            (folder / MOTION).unlink(missing_ok=True)
        write_masks(folder / MASKS, progress.each("masks", result.labels(store)))
        overlay = folder / OVERLAY
        if style is None:
            with blame_output(overlay):
                if overlay.exists() and is_own_overlay(overlay):
                    overlay.unlink()
        elif not has_full_size:
            shown = progress.each("overlay", result.frames(store))
            write_overlay(overlay, shown, result.labels(store, result.analysed_shape), fps, style, names=result.called)
        else:
            write_overlay(
                overlay,
                progress.each("overlay", origin.read_full()),
                result.labels(store),
                fps,
                style,
                names=result.called,
            )
        labels = progress.each("summary", result.labels(store))
        found = result.num_motions, result.motions, result.tags
        names = None if origin is None else origin.names
        beside = result.choices, result.moves(store), result.confidences(store)
        given = {
            "growths": result.growths(store),
            "given_names": result.names,
            "drawn": result.drawn,
            "advice": result.advice,
            "about_picture": result.about_picture(store),
        }
        summary = summarise_sequence(result.name, labels, fps, *found, names, *beside, **given)
        if origin is not None:
            summary = summary.model_copy(update={"video": origin.identity, "numbers": origin.numbers})
        write_motion(folder / MOTION, summary)
    return summary
