"""Moving objects without learned weights: from the saliency of frames to the sections' objects on the working grid."""

from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.sections import Section
from moseg.workflows.graph.video_networks import VideoNetworks
from moseg.workflows.stages.accumulation import PASSES
from moseg.workflows.stages.motion_network import uses_motion_network


class Foreground:
    """Writer of the recipes of the foreground and its components, one section at a time."""

    def __init__(self, nodes: Nodes, cues: FrameCues, sections: tuple[Section, ...]):
        self._nodes = nodes
        self._config = nodes.config
        self._cues = cues
        self._sections = sections
        self._video_networks = VideoNetworks(nodes, cues, sections)

    @cached_method
    def components(self, index: int) -> str:
        """Return the reference of a section's objects, up to the end of the frames shared with the next section."""
        section = self._sections[index]
        inputs = {
            "foreground": self.foregrounds(index),
            "frames": self._nodes.frames[section.start : section.proposal_stop],
            "saliency": self.saliency(section.start, section.proposal_stop),
        }
        steps = self.steps(section.start, section.proposal_stop)
        if steps != inputs["saliency"]:
            inputs["steps"] = steps
        return self._nodes.add(
            "components", inputs, num_frames=section.proposal_stop - section.start, gap=self._gap(index)
        )

    def foregrounds(self, index: int) -> tuple[str, ...]:
        """Return the references of the foreground of all frames in which a section's objects are labelled."""
        stop = self._sections[index].proposal_stop
        return tuple(
            self.foreground(other)
            for other, section in enumerate(self._sections[index:], index)
            if section.start < stop
        )

    def foreground(self, index: int) -> str:
        """Return the reference of the probability of motion of a section's pixels."""
        return self._video_networks.refine(index, self._motion_and_colour, self._coherence)

    @cached_method
    def _motion_and_colour(self, index: int) -> str:
        reach = (
            self._config.appearance.reach + 1
        )  # the appearance of both neighbouring sections, each of which has its own reach
        first = max(index - reach, 0)
        near = range(first, min(index + reach + 1, len(self._sections)))
        start = self._sections[index].start
        # Frames are counted from the first section that is read: a cut elsewhere in the video changes no key.
        place = {
            "start": start - self._sections[first].start,
            "centres": [self._centre(other) - self._sections[first].start for other in near],
            "own": index - first,
        }
        inputs = {
            "appearance": tuple(self.appearance(other) for other in near),
            **self._accumulated(index),
            **self._both("motion_memory", self._remember, index),
        }
        return self._nodes.add("foreground", inputs, **place)

    @cached_method
    def appearance(self, index: int) -> str:
        """Return the reference of the colours of a section's moving and static pixels."""
        section = self._sections[index]
        inputs = {"frames": self._nodes.frames[section.start : section.stop], **self._accumulated(index)}
        return self._nodes.add("appearance", inputs)

    def _accumulated(self, index: int) -> dict[str, str]:
        """Return the references of both passes over a section: of saliency and consistency, and of residuals."""
        return self._both("accumulation", self._accumulate, index) | self._coherence(index)

    def _coherence(self, index: int) -> dict[str, str]:
        return self._both("coherence", self._cohere, index)

    @cached_method
    def _own_motion(self, index: int) -> str:
        section = self._sections[index]
        place = self._cues.pictures.ends_in(section.start, section.stop)
        saliency = self.saliency(section.start, section.stop)
        inputs = {"saliency": saliency, **self._both("accumulation", self._accumulate, index)}
        return self._nodes.add("own_motion", inputs, **place)

    def _accumulate(self, index: int, origin: str, carried: dict[str, str]) -> str:
        inputs = {"saliency": self._steps(index), "consistency": self._consistency(index), **carried}
        looked_at: list[int] = []
        if uses_motion_network(self._config):
            section = self._sections[index]
            looked_at = self._cues.looked_at(section.start, section.stop)
            inputs["network"] = tuple(self._cues.motion_network(section.start + frame) for frame in looked_at)
        return self._nodes.add("accumulation", inputs, origin=origin, gap=self._gap(index), looked_at=looked_at)

    def _remember(self, index: int, origin: str, carried: dict[str, str]) -> str:
        inputs = {"saliency": self._steps(index), "consistency": self._consistency(index), **carried}
        inputs |= self._both("accumulation", self._accumulate, index)
        return self._nodes.add("motion_memory", inputs, origin=origin, gap=self._gap(index))

    def _cohere(self, index: int, origin: str, carried: dict[str, str]) -> str:
        inputs = {"saliency": self._steps(index), "own_motion": self._own_motion(index), **carried}
        return self._nodes.add("coherence", inputs, origin=origin, gap=self._gap(index))

    def _gap(self, index: int) -> int:
        return self._cues.pictures.gap_of(self._sections[index])

    @cached_method
    def _consistency(self, index: int) -> str:
        section = self._sections[index]
        first, last = max(section.start - 1, 0), min(section.stop + 1, len(self._nodes.frames))
        inputs = {"saliency": self.steps(first, last)}
        return self._nodes.add("consistency", inputs, first=section.start - first, last=section.stop - first)

    def saliency(self, start: int, stop: int) -> tuple[str, ...]:
        """Return the references of the saliency of frames in a row."""
        return tuple(self._cues.saliency(frame) for frame in range(start, stop))

    def steps(self, start: int, stop: int) -> tuple[str, ...]:
        """Return the references of the same with the flow to the frames right beside them."""
        return tuple(self._cues.steps(frame) for frame in range(start, stop))

    @cached_method
    def _steps(self, index: int) -> tuple[str, ...]:
        section = self._sections[index]
        return self.steps(section.start, section.stop)

    def _centre(self, index: int) -> float:
        section = self._sections[index]
        return (section.start + section.stop - 1) / 2

    def _both(self, name: str, write, index: int) -> dict[str, str]:
        """Return the references of both passes over a section."""
        return {f"{name}_{origin}": self._chain(write, origin)[index] for origin in PASSES}

    @cached_method
    def _chain(self, write, origin: str) -> tuple[str, ...]:
        """Return the references of one pass over all sections, each of which continues the one before it."""
        order = range(len(self._sections)) if origin == "past" else reversed(range(len(self._sections)))
        refs: dict[int, str] = {}
        carried: dict[str, str] = {}
        for index in order:
            refs[index] = write(index, origin, carried)
            carried = {"carried": refs[index]}
        return tuple(refs[index] for index in range(len(self._sections)))
