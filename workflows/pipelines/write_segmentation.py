"""The files that `moseg segment` writes: masks, overlay video and summary of the motions of one video."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from moseg.store import ArtifactStore
from moseg.workflows.exports.motion_json import SequenceSummary, summarise_sequence, write_motion
from moseg.workflows.exports.outputs import MASKS, MOTION, OVERLAY
from moseg.workflows.exports.overlay_style import DEFAULT_STYLE, OverlayStyle
from moseg.workflows.exports.ownership import is_own_overlay
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
    full_frames: Iterable[np.ndarray] | None = None,
    frames: tuple[str, ...] | None = None,
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
    full_frames : iterable of uint8 (y, x, rgb), optional
        Frames at the video's own size for the overlay, which is drawn at the size analysed where None.
    frames : tuple of str, optional
        File names of the frames, where they came from a folder.
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
        elif full_frames is None:
            shown = progress.each("overlay", result.frames(store))
            write_overlay(overlay, shown, result.labels(store, result.analysed_shape), fps, style)
        else:
            write_overlay(overlay, progress.each("overlay", full_frames), result.labels(store), fps, style)
        labels = progress.each("summary", result.labels(store))
        found = result.num_motions, result.motions, result.tags
        summary = summarise_sequence(result.name, labels, fps, *found, frames, result.choices, result.moves(store))
        write_motion(folder / MOTION, summary)
    return summary
