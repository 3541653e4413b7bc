"""Writers of the recipes of several scenes, which are asked by frames and sections of the whole video."""

from bisect import bisect_right
from collections.abc import Collection, Sequence
from itertools import accumulate
from typing import TYPE_CHECKING

from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.sections import Section

if TYPE_CHECKING:
    from moseg.workflows.graph.sequence_graph import SequenceGraph


class ScenePlaces:
    """Places of the frames and sections of a video in the graphs of its scenes.

    Attributes
    ----------
    scenes : tuple of SequenceGraph
    first_frames : tuple of int
        The frame of the video that is the first of each scene.
    sections : tuple of range
        The sections of the video that are those of each scene.
    """

    def __init__(self, scenes: Sequence["SequenceGraph"]):
        self.scenes = tuple(scenes)
        self.first_frames = (0, *accumulate(len(scene.leaves.frames) for scene in scenes[:-1]))
        first_sections = (0, *accumulate(len(scene.sections) for scene in scenes[:-1]))
        self.sections = tuple(
            range(first, first + len(scene.sections)) for first, scene in zip(first_sections, scenes, strict=True)
        )

    def of_frame(self, frame: int) -> tuple["SequenceGraph", int]:
        """Return the scene that a frame of the video lies in, and the frame counted from the scene's first."""
        place = bisect_right(self.first_frames, frame) - 1
        return self.scenes[place], frame - self.first_frames[place]

    def of_section(self, index: int) -> tuple["SequenceGraph", int]:
        """Return the scene that a section of the video lies in, and its index in the scene."""
        place = bisect_right(self.sections, index, key=lambda sections: sections.start) - 1
        return self.scenes[place], index - self.sections[place].start

    def cut_sections(self) -> tuple[Section, ...]:
        """Return the sections of all scenes, with frames of the video."""
        return tuple(
            Section(*(first + frame for frame in section))
            for first, scene in zip(self.first_frames, self.scenes, strict=True)
            for section in scene.sections
        )


class JoinedPictures:
    """Pictures of all scenes; see `Pictures`."""

    def __init__(self, places: ScenePlaces):
        self._places = places

    @property
    def followed(self) -> Collection[int]:
        """Frames that are compared with a later picture of their scene."""
        places = zip(self._places.first_frames, self._places.scenes, strict=True)
        frames = (first + frame for first, scene in places for frame in scene.frame_cues.pictures.followed)
        return dict.fromkeys(frames).keys()

    def gap(self, frame: int) -> int:
        """Return how many pictures farther the one is that a frame is compared with."""
        scene, own = self._places.of_frame(frame)
        return scene.frame_cues.pictures.gap(own)

    def shares(self, frame: int) -> dict[str, float]:
        """Return the shares of a frame's motion that lie between it and the frames right beside it, by side."""
        scene, own = self._places.of_frame(frame)
        return scene.frame_cues.pictures.shares(own)

    def ends_in(self, start: int, stop: int) -> dict[str, int]:
        """Return which of the frames start..stop, all of one scene, lack a neighbour."""
        scene, first = self._places.of_frame(start)
        return scene.frame_cues.pictures.ends_in(first, first + stop - start)


class JoinedCues:
    """Writer of the recipes of the cues of frames; see `FrameCues`."""

    def __init__(self, places: ScenePlaces):
        self._places = places
        self.pictures = JoinedPictures(places)

    def flow(self, frame0: int, frame1: int) -> str:
        """Return the reference of the flow from one frame to another of its scene."""
        scene, frame = self._places.of_frame(frame0)
        return scene.frame_cues.flow(frame, frame + frame1 - frame0)

    def flow_to_next(self, frame: int) -> str:
        """Return the reference of the flow from one frame to the next picture of its scene, which must be there."""
        scene, own = self._places.of_frame(frame)
        return scene.frame_cues.flow_to_next(own)

    def depth(self, frame: int) -> str:
        """Return the reference of a frame's inverse depth."""
        scene, own = self._places.of_frame(frame)
        return scene.frame_cues.depth(own)

    def saliency(self, frame: int) -> str:
        """Return the reference of a frame's motion saliency."""
        scene, own = self._places.of_frame(frame)
        return scene.frame_cues.saliency(own)


class JoinedForeground:
    """Writer of the recipes of the foreground; see `Foreground`."""

    def __init__(self, places: ScenePlaces):
        self._places = places

    def foreground(self, index: int) -> str:
        """Return the reference of the probability of motion of a section's pixels."""
        scene, own = self._places.of_section(index)
        return scene.foreground.foreground(own)

    def saliency(self, start: int, stop: int) -> tuple[str, ...]:
        """Return the references of the saliency of frames in a row, all of one scene."""
        scene, first = self._places.of_frame(start)
        return scene.foreground.saliency(first, first + stop - start)


class JoinedTrackProposals:
    """Writer of the recipes of the objects of dense tracks; see `TrackProposals`."""

    def __init__(self, places: ScenePlaces):
        self._places = places

    def first_row(self, index: int) -> int:
        """Return the frame of a section's window that is the section's first."""
        scene, own = self._places.of_section(index)
        return scene.objects.track_proposals.first_row(own)

    def dense_tracks(self, index: int) -> str:
        """Return the reference of the point tracks of a section's window."""
        scene, own = self._places.of_section(index)
        return scene.objects.track_proposals.dense_tracks(own)

    def objects(self, index: int) -> str:
        """Return the reference of the objects of these tracks."""
        scene, own = self._places.of_section(index)
        return scene.objects.track_proposals.objects(own)


class JoinedObjects:
    """Writer of the recipes of the objects of every section; see `Objects`."""

    def __init__(self, nodes: Nodes, places: ScenePlaces):
        self._nodes = nodes
        self._places = places
        self.track_proposals = JoinedTrackProposals(places)

    @cached_method
    def linking(self) -> str:
        """Return the reference of the identities of all scenes' objects, which no two scenes share."""
        scenes = tuple(scene.objects.linking() for scene in self._places.scenes)
        return self._nodes.add("linking", {"scenes": scenes}, "scenes")

    def proposals(self, index: int) -> str:
        """Return the reference of a section's object proposals."""
        scene, own = self._places.of_section(index)
        return scene.objects.proposals(own)

    def source_of(self, index: int) -> str:
        """Return the source of a section's proposals."""
        scene, own = self._places.of_section(index)
        return scene.objects.source_of(own)

    def regions_of(self, index: int) -> str:
        """Return where a section's moving regions come from."""
        scene, own = self._places.of_section(index)
        return scene.objects.regions_of(own)

    @property
    def uses_saliency(self) -> bool:
        """Return whether the moving regions of any section come from saliency."""
        return any(scene.objects.uses_saliency for scene in self._places.scenes)


class JoinedMotions:
    """Writer of the recipes of point tracks; see `Motions`. Each scene has affinities and residuals of its own."""

    def __init__(self, places: ScenePlaces):
        self._places = places

    def tracks(self, index: int) -> str:
        """Return the reference of a section's point tracks."""
        scene, own = self._places.of_section(index)
        return scene.motions.tracks(own)
