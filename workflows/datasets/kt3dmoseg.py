"""KT3DMoSeg (Xu et al. 2018): clips of KITTI as labelled trajectories, without images."""

import os
from dataclasses import dataclass

from moseg.workflows import sources
from moseg.workflows.datasets.dataset import TrajectorySource
from moseg.workflows.datasets.kt3dinsmoseg import CLIPS
from moseg.workflows.sources.files import natural_key, unreadable

SUFFIX = "_Tracks.mat"


@dataclass(frozen=True)
class Kt3dMoSeg:
    """``<root>/<clip>_Tracks.mat``."""

    name: str = "kt3dmoseg"
    needs_root: bool = True
    official: tuple[str, ...] = tuple(CLIPS.split())
    list_name: None = None
    ground_truth: str = "the motion of every trajectory, the background's among them"
    tree: str = (
        "<clip>_Tracks.mat, each a struct Data with ySparse (3, N, F) homogeneous xy in px, visibleSparse (N, F) and"
        " GtLabel (N)"
    )
    source: str = "the folder Data of https://github.com/alex-xun-xu/MultiViewMoSeg"

    def on_disk(self, root: str) -> tuple[str, ...]:
        """Clips with trajectories."""
        try:
            files = [name for name in os.listdir(root) if name.endswith(SUFFIX) and not name.startswith(".")]
        except OSError as error:
            raise unreadable(root, error) from error
        return tuple(name.removesuffix(SUFFIX) for name in sorted(files, key=natural_key))

    def open_trajectories(self, root: str, name: str) -> TrajectorySource:
        """The sources of one clip."""
        path = os.path.join(root, name + SUFFIX)
        return TrajectorySource(name, sources.TrajectoryFile(path), sources.TrajectoryLabels(path))


KT3DMOSEG = Kt3dMoSeg()
