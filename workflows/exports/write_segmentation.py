"""All that `moseg segment` leaves: masks, overlay video and summary of the motions of one video."""

from pathlib import Path

from store import ArtifactStore
from workflows.exports.motion_json import SequenceSummary, summarise_sequence, write_motion
from workflows.exports.write_masks import write_masks
from workflows.exports.write_overlay import write_overlay
from workflows.segment import MotionSegmentation


def write_segmentation(folder: Path, store: ArtifactStore, result: MotionSegmentation, fps: float) -> SequenceSummary:
    """Write ``masks/00000.png`` … and ``motion.json`` at the video's own size, ``overlay.mp4`` at the size analysed.

    Returns
    -------
    SequenceSummary
        What ``motion.json`` holds.

    Raises
    ------
    InputError
        Where the folder cannot be written.
    """
    write_masks(folder / "masks", result.labels(store))
    write_overlay(folder / "overlay.mp4", result.frames(store), result.labels(store, result.analysed_shape), fps)
    labels = result.labels(store)
    summary = summarise_sequence(result.name, labels, fps, result.num_motions, result.motions, result.tags)
    write_motion(folder / "motion.json", summary)
    return summary
