"""KT3DInsMoSeg: the KITTI clips of KT3DMoSeg (Xu et al. 2018) with a mask for every moving instance."""

import os
from dataclasses import dataclass

from workflows.datasets.annotated import annotated_sequence
from workflows.datasets.dataset import SequenceSource
from workflows.datasets.sequence_folders import find_frames, list_sequences

FRAME_FOLDERS = ("images", "image_02/data", "image_02", "frames")
"""Where a clip's frames may lie, first found first; ``image_02/data`` is KITTI raw's own."""
CLIPS = """
Seq005_Clip01 Seq005_Clip02 Seq009_Clip01 Seq009_Clip02 Seq009_Clip03 Seq011_Clip01 Seq013_Clip01 Seq013_Clip02
Seq020_Clip01 Seq028_Clip01 Seq028_Clip02 Seq028_clip03 Seq037_Clip01 Seq038_Clip01 Seq038_Clip02 Seq045_Clip01
Seq059_Clip01 Seq070_Clip01 Seq071_Clip01 Seq084_Clip01 Seq095_Clip01 Seq113_Clip01
"""
"""As named in KT3DMoSeg's release, spelling included."""


@dataclass(frozen=True)
class Kt3dInsMoSeg:
    """``<root>/<clip>/image_02/*.png`` and ``<root>/<clip>/masks/*.png``, matched by stem."""

    name: str = "kt3dinsmoseg"
    needs_root: bool = True
    official: tuple[str, ...] = tuple(CLIPS.split())
    list_name: None = None
    ground_truth: str = "instance masks, annotated frames; 255 is void"
    tree: str = "<clip>/images/*.png (or <clip>/image_02) and <clip>/masks/*.png"
    source: str = (
        "frames from https://www.cvlibs.net/datasets/kitti/raw_data.php, clips of "
        "https://github.com/alex-xun-xu/MultiViewMoSeg, masks from the authors of KT3DInsMoSeg"
    )

    def on_disk(self, root: str) -> tuple[str, ...]:
        """Clips with frames."""
        return list_sequences(root, FRAME_FOLDERS)

    def open_sequence(self, root: str, name: str, max_side: int) -> SequenceSource:
        """The sources of one clip."""
        clip = os.path.join(root, name)
        frames = find_frames(clip, FRAME_FOLDERS)
        return annotated_sequence(name, frames, os.path.join(clip, "masks"), "instance", 255, max_side)


KT3DINSMOSEG = Kt3dInsMoSeg()
