"""Rendered scenes with exact ground truth and cues: the default data set, without any download."""

from dataclasses import dataclass

from moseg.tasks.synthetic import SCENES
from moseg.workflows import sources
from moseg.workflows.datasets.dataset import SequenceSource


@dataclass(frozen=True)
class RenderedScenes:
    """A sequence for each declared scene. Scenes are small, and their size is not changed."""

    name: str = "synthetic"
    needs_root: bool = False
    official: tuple[str, ...] = tuple(SCENES)
    list_name: None = None
    ground_truth: str = "exact instance masks, flow, depth and tracks, every frame"
    tree: str = "no files"
    source: str = "rendered, no download"

    def on_disk(self, root: None) -> tuple[str, ...]:
        """Return all scenes."""
        return tuple(SCENES)

    def open_sequence(self, root: None, name: str, max_side: int) -> SequenceSource:
        """Return the sources of one scene."""
        return SequenceSource(
            name,
            frames=sources.SceneFrames(name),
            annotations=sources.SceneMasks(name, "moving"),
            num_motions=sources.find_scene(name).num_motions,
            objects=sources.SceneMasks(name, "objects"),
            depth=sources.SceneDepth(name),
            flow_forward=sources.SceneFlow(name, "forward"),
            flow_backward=sources.SceneFlow(name, "backward"),
            tracks=sources.SceneTracks(name),
        )


SYNTHETIC = RenderedScenes()
