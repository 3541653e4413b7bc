"""Export of what `moseg segment` left in a folder, without a store."""

from collections.abc import Iterable
from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.workflows.api.video_source import named_video
from moseg.workflows.config.frame_range import Position
from moseg.workflows.exports import check_folder
from moseg.workflows.exports.formats import choose_formats, export
from moseg.workflows.exports.formats.reconstruction_sets import choose_kept, choose_sets
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.motion_json import SequenceSummary
from moseg.workflows.exports.saved_segmentation import open_segmentation, required_origin
from moseg.workflows.sources import open_frames
from moseg.workflows.sources.pillow_image import MAX_PIXELS


def export_saved(
    folder: str,
    out: str | None,
    formats: Iterable[str],
    sets: Iterable[str] = (),
    images: str | None = None,
    video: str | None = None,
    step: Position | None = None,
    name: str | None = None,
    dilation: int | None = None,
) -> tuple[int, tuple[Path, ...]]:
    """Write finished masks for other programs, and return the number of frames and what was written.

    Parameters
    ----------
    folder : str
        What `moseg segment` left.
    out : str or None
        Folder to write in; the same where None.
    formats, sets : iterable of str
        Formats, and programs for which frames and masks are written.
    images : str, optional
        Folder of the frames, whose file names count.
    video : str, optional
        The video or the folder of frames, for what contains the frames.
    step : Position, optional
        Which of the frames a set has.
    name : str, optional
        Of the sequence.
    dilation : int, optional
        How far what moves is widened where it is to be ignored, px.

    Raises
    ------
    InputError
        Something is missing or does not fit, or a file cannot be written.
    """
    chosen_sets = choose_sets(sets)
    chosen = choose_formats(formats, None if chosen_sets and not formats else dilation)
    saved = open_segmentation(Path(folder), None if images is None else Path(images), name)
    if video is not None:
        saved = saved.from_video(_open_origin(video, saved.summary))
    target = Path(folder if out is None else out)
    for entry in (*chosen, *chosen_sets):
        if entry.needs_frames:
            required_origin(saved.origin, entry.name)
    check_folder(target)
    written = export(saved, chosen, target, dilation)
    if chosen_sets:
        kept = choose_kept(required_origin(saved.origin), saved.summary.num_frames, step, saved.summary.fps)
        thinned = saved if kept is None else saved.thin(kept)
        written = (*written, *export(thinned, chosen_sets, target, dilation))
        return len(thinned.names), written
    return saved.summary.num_frames, written


def _open_origin(video: str, summary: SequenceSummary) -> FrameOrigin:
    """Return the frames that were segmented, of a video or folder that must be the same one."""
    path = named_video(video)
    origin = FrameOrigin(path, open_frames(path, MAX_PIXELS))
    if summary.video is not None and origin.identity != summary.video:
        origin.frames.describe()
        raise InputError("another video", where="--video", got=video, expected=f"the one of {summary.name!r}")
    if origin.names is not None and summary.frames is not None:
        place = {name: index for index, name in enumerate(origin.names)}
        missing = next((name for name in summary.frames if name not in place), None)
        if missing is not None:
            raise InputError("no such frame", where=path, got=missing, expected="the frames that were segmented")
        return origin.choose(tuple(place[name] for name in summary.frames))
    return origin.choose(summary.numbers)
