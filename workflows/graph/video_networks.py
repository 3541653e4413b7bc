"""Networks trained on the video itself, one for each stretch of whole sections."""

from collections.abc import Callable

from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.sections import Section
from moseg.workflows.graph.stretches import Stretch, cut_stretches

SectionRef = Callable[[int], str]
SectionRefs = Callable[[int], dict[str, str]]
"""Functions from the index of a section to a reference, and to references by role."""


class VideoNetworks:
    """Writer of the recipes of networks trained on stretches of the video, and of what they add to the foreground."""

    def __init__(self, nodes: Nodes, cues: FrameCues, sections: tuple[Section, ...]):
        self._nodes = nodes
        self._params = nodes.config.video_network
        self._frames = nodes.frames
        self._cues = cues
        self._sections = sections
        length = max(round(self._params.stretch_length / nodes.config.sections.length), 1)
        self._stretches = cut_stretches(len(sections), length)

    @cached_method
    def refine(self, index: int, foreground: SectionRef, coherence: SectionRefs) -> str:
        """Return the reference of a section's foreground, with the network of its stretch if one is used."""
        if self._params.use == "never":
            return foreground(index)
        section = self._sections[index]
        inputs = {
            "frames": self._frames[section.start : section.stop],
            "foreground": foreground(index),
            "video_network": self._network(self._stretch_of(index), foreground, coherence),
        }
        return self._nodes.add("foreground", inputs, "video-network")

    def _stretch_of(self, index: int) -> Stretch:
        return next(stretch for stretch in self._stretches if index < stretch.stop)

    @cached_method
    def _network(self, stretch: Stretch, foreground: SectionRef, coherence: SectionRefs) -> str:
        indices = range(stretch.start, stretch.stop)
        start, stop = self._sections[stretch.start].start, self._sections[stretch.stop - 1].stop
        inputs = {
            "frames": self._frames[start:stop],
            "foreground": tuple(foreground(index) for index in indices),
            "motion_proof": tuple(self._proof(index) for index in indices),
        }
        passes = [coherence(index) for index in indices]
        inputs |= {role: tuple(refs[role] for refs in passes) for role in passes[0]}
        return self._nodes.add("video_network", inputs)

    @cached_method
    def _proof(self, index: int) -> str:
        section = self._sections[index]
        frames, pictures = range(section.start, section.stop), self._cues.pictures
        first, last = max(section.start - 1, 0), min(section.stop + 1, len(self._frames))
        saliency = tuple(self._cues.saliency(frame) for frame in frames)
        steps = tuple(self._cues.steps(frame) for frame in frames)
        if steps == saliency:
            inputs = {"frames": self._frames[first:last], "saliency": saliency}
            return self._nodes.add("motion_proof", inputs, first=section.start - first)
        neighbours = [(pictures.previous(frame), pictures.next(frame)) for frame in frames]
        read = sorted({frame for pair in neighbours for frame in pair if frame is not None} | {*frames})
        row_of = {frame: row for row, frame in enumerate(read)}
        rows = [[row_of[frame], *map(row_of.get, pair)] for frame, pair in zip(frames, neighbours, strict=True)]
        inputs = {"frames": tuple(self._frames[frame] for frame in read), "saliency": saliency, "steps": steps}
        return self._nodes.add("motion_proof", inputs, "repeated", rows=rows)
