"""Objects of dense tracks: from a section's window to the tracks, their rigidity, and the objects that they form."""

from typing import NamedTuple

from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.sections import Section


class Window(NamedTuple):
    """Frames first..last of a section's dense tracks; its objects are labelled from the section's start to `last`."""

    first: int
    last: int


class TrackProposals:
    """Writer of the recipes of the objects of dense tracks, one section at a time."""

    def __init__(self, nodes: Nodes, cues: FrameCues, sections: tuple[Section, ...]):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves
        self._cues = cues
        self._sections = sections

    def window(self, index: int) -> Window:
        """Return the window of a section: that of a short last section begins before it."""
        section, params = self._sections[index], self._config.track_window
        last = min(section.stop + params.overlap, len(self._nodes.frames))
        return Window(max(min(section.start, last - params.min_frames), 0), last)

    def first_row(self, index: int) -> int:
        """Return the frame of the window that is the section's first."""
        return self._sections[index].start - self.window(index).first

    @cached_method
    def dense_tracks(self, index: int, step: int = 1, gap: int = 1) -> str:
        """Return the reference of the point tracks of a section's window, for pairs that begin every `step` frames.

        The frames of a pair are `gap` times as far apart as elsewhere.
        """
        first, last = self.window(index)
        pairs = [(frame, frame + 1) for frame in range(first, last - 1)]
        inputs = {
            "frames": self._nodes.frames[first:last],
            "flow_forward": tuple(self._cues.flow(frame0, frame1) for frame0, frame1 in pairs),
            "flow_backward": tuple(self._cues.flow(frame1, frame0) for frame0, frame1 in pairs),
        }
        return self._nodes.add("dense_tracks", inputs, step=step, gap=gap, **self._leaves.hidden())

    @cached_method
    def cameras(self, index: int) -> str:
        """Return the reference of the cameras of the frames of a section's window, by a network."""
        first, last = self.window(index)
        return self._nodes.add("cameras", {"frames": self._nodes.frames[first:last]}, **self._leaves.picture())

    @cached_method
    def rigidity(self, index: int, step: int = 1, gap: int = 1) -> str:
        """Return the reference of the deviation of these tracks from a rigid scene, in the same pairs."""
        first, last = self.window(index)
        inputs = {"dense_tracks": self.dense_tracks(index, step, gap), "frames": self._nodes.frames[first:last]}
        if self._config.cameras.method != "tracks":
            inputs["cameras"] = self.cameras(index)
        elif self._config.depth.method != "none":
            inputs["depth"] = tuple(self._cues.depth(frame) for frame in range(first, last))
        return self._nodes.add("rigidity", inputs, step=step, gap=gap, **self._leaves.picture())

    @cached_method
    def objects(self, index: int) -> str:
        """Return the reference of the objects of these tracks."""
        tracks = {"dense_tracks": self.dense_tracks(index)}
        rigidity = {"rigidity": self.rigidity(index)}
        moving = {"moving_tracks": self._nodes.add("moving_tracks", {**tracks, **rigidity})}
        groups = {"track_groups": self._nodes.add("track_groups", {**tracks, **moving})}
        surfaces = {"track_surfaces": self.surfaces(index)}
        inputs = {**tracks, **rigidity, **moving, **groups, **surfaces}
        return self._nodes.add("track_objects", inputs, shape=self._leaves.shape, **self._leaves.picture())

    @cached_method
    def surfaces(self, index: int) -> str:
        """Return the reference of the surfaces of these tracks that stand above the ground."""
        inputs = {"dense_tracks": self.dense_tracks(index), "rigidity": self.rigidity(index)}
        return self._nodes.add("track_surfaces", inputs, shape=self._leaves.shape, **self._leaves.picture())

    def object_points(self, index: int) -> str:
        """Return the reference of more points of these objects, followed by the objects' own motion."""
        first, last = self.window(index)
        tracks = {"dense_tracks": self.dense_tracks(index), "track_objects": self.objects(index)}
        inputs = {"frames": self._nodes.frames[first:last], **tracks}
        return self._nodes.add("object_points", inputs, **self._leaves.picture())

    def proposals(self, index: int) -> str:
        """Return the reference of the masks of these objects, from the section's start to the end of the window."""
        start, last = self._sections[index].start, self.window(index).last
        inputs = {
            "frames": self._nodes.frames[start:last],
            "dense_tracks": self.dense_tracks(index),
            "track_objects": self.objects(index),
            "object_points": self.object_points(index),
            "track_surfaces": self.surfaces(index),
            "flow_next": tuple(self._cues.flow(frame, frame + 1) for frame in range(start, last - 1)),
            "flow_previous": self._cues.flow(last - 1, last - 2),
        }
        return self._nodes.add("proposals", inputs, "tracks", start=self.first_row(index), section=index)
