"""Sources for paths that a user gives."""

import os

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources.depth_files import DEPTH_SUFFIXES, DepthFiles
from moseg.workflows.sources.files import IMAGE_SUFFIXES, list_files, stem
from moseg.workflows.sources.flow_files import FLOW_SUFFIXES, FlowFiles
from moseg.workflows.sources.frame_matching import check_pairs, frame_stems, match_names
from moseg.workflows.sources.frames import FrameSource
from moseg.workflows.sources.image_files import ImageFiles
from moseg.workflows.sources.mask_files import MASK_SUFFIXES, MaskFiles, MaskKind, find_mask_kind
from moseg.workflows.sources.track_files import TRACK_SUFFIXES, TrackFile
from moseg.workflows.sources.video_file import VIDEOS, VideoFile


def open_frames(path: str, max_side: int) -> ImageFiles | VideoFile:
    """Open the frames of a video file, or of a folder of images in natural order.

    Raises
    ------
    MissingInputError
        `path` does not exist, or the folder holds no image.
    """
    path = os.path.abspath(path)
    if os.path.isdir(path):
        images = list_files(path, IMAGE_SUFFIXES)
        if not images:
            raise MissingInputError("no images", where=path, expected=f"files of {' '.join(IMAGE_SUFFIXES)}")
        return ImageFiles(images, max_side)
    if not os.path.exists(path):
        raise MissingInputError("file does not exist", where=path, expected="a video or a folder of images")
    if not os.path.isfile(path):
        raise InputError("not a file", where=path, expected=VIDEOS)
    if path.lower().endswith(IMAGE_SUFFIXES):
        return ImageFiles((path,), max_side)
    return VideoFile(path, max_side)


def open_masks(folder: str, frames: FrameSource, kind: MaskKind | None = None) -> MaskFiles:
    """Open the masks of a folder, matched to frames by file stem; frames may lack a mask.

    Parameters
    ----------
    folder : str
    frames : FrameSource
        For images a mask's stem is its frame's. Frames of a video have no names: as many masks as frames are the frames
        in order; with fewer, the last number in a mask's name is its frame, counted from 0.
    kind : 'binary', 'instance' or None
        Found from the values if None (`find_mask_kind`).

    Raises
    ------
    MissingInputError
        The folder does not exist or holds no PNG.
    InputError
        A mask without a frame.
    """
    folder = os.path.abspath(folder)
    masks = list_files(folder, MASK_SUFFIXES)
    if not masks:
        raise MissingInputError("no masks", where=folder, expected="PNG files named as their frames")
    masks = _of_chosen(masks, frames, folder)
    stems = frame_stems(frames)
    if stems is None:
        _, indices = match_names(tuple(map(stem, masks)), None, frames.num_frames(), folder)
    else:
        index_of = {name: index for index, name in enumerate(stems)}
        indices = tuple(_frame_of(path, index_of) for path in masks)
    items = tuple(sorted(zip(indices, masks, strict=True)))
    return MaskFiles(items, kind or find_mask_kind(masks), frames.describe().size)


def open_depth(folder: str, frames: FrameSource, num_frames: int, max_side: int) -> DepthFiles:
    """Open the depth maps of a folder, one per frame, matched to the frames by `match_names`.

    Raises
    ------
    InputError
        Their number is not `num_frames`, or only some have the name of a frame.
    """
    folder = os.path.abspath(folder)
    paths = _of_chosen(list_files(folder, DEPTH_SUFFIXES), frames, folder)
    if len(paths) != num_frames:
        expected = f"{num_frames} files ({' or '.join(DEPTH_SUFFIXES)}), one for each frame"
        raise InputError("wrong number of depth maps", where=folder, got=len(paths), expected=expected)
    _, indices = match_names(tuple(map(stem, paths)), frame_stems(frames), num_frames, folder)
    in_order = tuple(path for _, path in sorted(zip(indices, paths, strict=True)))
    return DepthFiles(in_order, frames.describe().size, max_side)


def open_flow(folder: str, frames: FrameSource, num_frames: int, max_side: int) -> FlowFiles:
    """Open the flow fields of a folder in natural order, one per frame pair.

    Raises
    ------
    InputError
        Their number is not `num_frames` - 1, or their names show that one of them is missing: see `check_pairs`.
    """
    folder = os.path.abspath(folder)
    paths = list_files(folder, FLOW_SUFFIXES)
    if len(paths) != num_frames - 1:
        of_part = " of the chosen part" if isinstance(frames, ImageFiles) and frames.left_out else ""
        pairs = f"one for each pair of neighbouring frames{of_part}"
        expected = f"{num_frames - 1} files ({' or '.join(FLOW_SUFFIXES)}), {pairs}"
        raise InputError("wrong number of flow fields", where=folder, got=len(paths), expected=expected)
    check_pairs(tuple(map(stem, paths)), frame_stems(frames), folder)
    return FlowFiles(paths, frames.describe().size, max_side)


def open_tracks(path: str, name: str, frames: FrameSource, num_frames: int, max_side: int) -> TrackFile:
    """Open the point tracks of the sequence `name`: the file `path`, or in that folder ``<name>.npz`` or the only .npz.

    Raises
    ------
    MissingInputError
        The folder holds no .npz.
    InputError
        Several files of which none is named as the sequence, or a file that is not .npz.
    """
    path = os.path.abspath(path)
    if not os.path.isdir(path):
        if not path.lower().endswith(TRACK_SUFFIXES):
            raise InputError("not tracks", where=path, expected=f"a file of {' '.join(TRACK_SUFFIXES)}")
        return TrackFile(path, num_frames, frames.describe().size, max_side)
    files = list_files(path, TRACK_SUFFIXES)
    named = tuple(file for file in files if stem(file) == name) or files
    if not named:
        raise MissingInputError("no tracks", where=path, expected=f"{name}.npz")
    if len(named) > 1:
        raise InputError("no tracks of this sequence", where=path, got=f"{len(files)} files", expected=f"{name}.npz")
    return TrackFile(named[0], num_frames, frames.describe().size, max_side)


def _of_chosen(paths: tuple[str, ...], frames: FrameSource, folder: str) -> tuple[str, ...]:
    """Return the files without those that are named as frames of the folder which were not chosen."""
    if not isinstance(frames, ImageFiles) or not frames.left_out:
        return paths
    chosen = tuple(path for path in paths if stem(path) not in frames.left_out)
    if paths and not chosen:
        got, expected = f"{len(paths)} files of other frames", "files named as the chosen frames"
        raise MissingInputError("no file of the chosen part", where=folder, got=got, expected=expected)
    return chosen


def _frame_of(path: str, index_of: dict[str, int]) -> int:
    if stem(path) not in index_of:
        raise InputError("mask without a frame", where=path, expected="a file named as a frame")
    return index_of[stem(path)]
