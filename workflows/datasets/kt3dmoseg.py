"""KT3DMoSeg (Xu et al. 2018), clips of KITTI as labelled trajectories, and KT3DInsMoSeg, the same clips as frames.

KT3DInsMoSeg has a mask for every moving instance. The masks are not public, the labelled trajectories of the clips are.
A clip that has them and no masks is scored at the labelled points.
"""

import os
from dataclasses import dataclass

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows import sources
from moseg.workflows.datasets.dataset import SequenceSource
from moseg.workflows.datasets.labelled_tracks import STRUCT_LAYOUT, TRACKS_SUFFIX, LabelledTracks
from moseg.workflows.datasets.sequence_folders import annotated_sequence, find_frames, holds_images, list_sequences
from moseg.workflows.sources.files import unreadable

FRAME_FOLDERS = ("images", "image_02/data", "image_02", "frames")
"""Folders of a clip's frames, of which the first that exists is used; ``image_02/data`` is KITTI raw's."""
CLIPS = """
Seq005_Clip01 Seq005_Clip02 Seq009_Clip01 Seq009_Clip02 Seq009_Clip03 Seq011_Clip01 Seq013_Clip01 Seq013_Clip02
Seq020_Clip01 Seq028_Clip01 Seq028_Clip02 Seq028_clip03 Seq037_Clip01 Seq038_Clip01 Seq038_Clip02 Seq045_Clip01
Seq059_Clip01 Seq070_Clip01 Seq071_Clip01 Seq084_Clip01 Seq095_Clip01 Seq113_Clip01
"""
"""Names in KT3DMoSeg's release, with its spelling."""


@dataclass(frozen=True)
class Kt3dInsMoSeg:
    """A folder of frames for each clip, with ground truth in one of two layouts.

    Masks, ``<root>/<clip>/masks/*.png``, are matched to frames by stem. If there are none, labelled trajectories are
    the first found of ``<root>/<clip>/<clip>_Tracks.mat``, the only ``*_Tracks.mat`` of ``<root>/<clip>``, and
    ``<root>/<clip>_Tracks.mat``. They follow points through all frames of the clip: its folder must hold these images
    and no others, whatever the number of the first.
    """

    name: str = "kt3dinsmoseg"
    needs_root: bool = True
    official: tuple[str, ...] = tuple(CLIPS.split())
    list_name: None = None
    ground_truth: str = "instance masks, annotated frames (255 is void); or labelled points, if a clip has no masks"
    tree: str = (
        "<clip>/images/*.png (or <clip>/image_02) and <clip>/masks/*.png; "
        "or <clip>/images/*.png (or <clip>/image_02) and <clip>/<clip>_Tracks.mat (or <clip>_Tracks.mat)"
    )
    source: str = (
        "frames from https://www.cvlibs.net/datasets/kitti/raw_data.php, clips and trajectories of "
        "https://github.com/alex-xun-xu/MultiViewMoSeg, masks from the authors of KT3DInsMoSeg"
    )

    def on_disk(self, root: str) -> tuple[str, ...]:
        """Return the clips with frames."""
        return list_sequences(root, FRAME_FOLDERS)

    def open_sequence(self, root: str, name: str, max_side: int) -> SequenceSource:
        """Return the sources of one clip: with its masks, else with its labelled points.

        Raises
        ------
        MissingInputError
            Neither is there.
        """
        clip = os.path.join(root, name)
        folder, masks = find_frames(clip, FRAME_FOLDERS), os.path.join(clip, "masks")
        if holds_images(masks):
            return annotated_sequence(name, folder, masks, "instance", 255, max_side)
        tracks = find_tracks(root, name)
        if tracks is None:
            expected = f"masks in {masks}, or labelled trajectories in {os.path.join(clip, name + TRACKS_SUFFIX)}"
            raise MissingInputError(f"sequence {name} has no annotations", expected=expected)
        frames = sources.open_frames(folder, max_side)
        points = sources.LabelledPointFile(tracks, frames.num_frames(), frames.describe().size)
        return SequenceSource(name, frames, labelled_points=points)


def find_tracks(root: str, clip: str) -> str | None:
    """Return the path of a clip's labelled trajectories; None if there are none.

    Raises
    ------
    InputError
        Several files in the clip's folder of which none has its name.
    """
    folder = os.path.join(root, clip)
    found, beside = _tracks_in(folder), _tracks_in(root)
    own = (clip + TRACKS_SUFFIX).casefold()
    if own in found:
        return found[own]
    if len(found) > 1:
        names = ", ".join(os.path.basename(path) for path in found.values())
        raise InputError("no trajectories of this clip", where=folder, got=names, expected=clip + TRACKS_SUFFIX)
    return next(iter(found.values()), beside.get(own))


def _tracks_in(folder: str) -> dict[str, str]:
    """Return the paths of a folder's files of trajectories by their name in lower case."""
    try:
        names = [name for name in sorted(os.listdir(folder)) if not name.startswith(".")]
    except OSError as error:
        raise unreadable(folder, error) from error
    suffix = TRACKS_SUFFIX.casefold()
    return {name.casefold(): os.path.join(folder, name) for name in names if name.casefold().endswith(suffix)}


KT3DINSMOSEG = Kt3dInsMoSeg()
KT3DMOSEG = LabelledTracks(
    name="kt3dmoseg",
    official=tuple(CLIPS.split()),
    suffixes=(TRACKS_SUFFIX,),
    tree=f"<clip>{TRACKS_SUFFIX}, each {STRUCT_LAYOUT}",
    source="the folder Data of https://github.com/alex-xun-xu/MultiViewMoSeg",
)
