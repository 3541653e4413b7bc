"""Objects: proposed in every section, with identities that last through the sequence."""

from moseg.workflows.graph.foreground import Foreground
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.once import once
from moseg.workflows.graph.sections import Section
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES


class Objects:
    """Writes the recipes of the objects of every section."""

    def __init__(self, nodes: Nodes, foreground: Foreground, sections: tuple[Section, ...]):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves
        self._foreground = foreground
        self._sections = sections
        self._proposals: list[str] = []

    def proposals(self, index: int) -> str:
        """Reference of a section's object proposals."""
        # In order, because a section starts with what was tracked into it.
        while len(self._proposals) <= index:
            self._proposals.append(self._propose(len(self._proposals)))
        return self._proposals[index]

    @once
    def linking(self) -> str:
        """Reference of the identities of the sections' objects."""
        proposals = tuple(self.proposals(index) for index in range(len(self._sections)))
        if self._config.proposal_source != "saliency":
            return self._nodes.add("linking", {"proposals": proposals})
        lengths = [section.stop - section.start for section in self._sections]
        return self._nodes.add("linking", {"proposals": proposals}, lengths=lengths)

    def labelled_until(self, index: int) -> int:
        """End of the frames in which a section's objects are labelled."""
        section = self._sections[index]
        if self._config.proposal_source == "detections":
            # The next section takes up what was tracked into its first frame.
            return min(section.stop + 1, len(self._leaves.frames))
        return section.proposal_stop

    def _propose(self, index: int) -> str:
        section = self._sections[index]
        if self._config.proposal_source in GIVEN_SOURCES:
            masks = self._nodes.required("masks", f"proposals: {self._config.proposal_source}")
            place = {"start": section.start, "stop": section.proposal_stop}
            given = {"shape": self._leaves.shape, "void": self._leaves.masks_void}
            return self._nodes.add("proposals", {"masks": masks}, **place, **given)
        if self._config.proposal_source == "detections":
            return self._track_objects(index)
        frames = self._leaves.frames[section.start : section.proposal_stop]
        inputs = {
            "frames": frames,
            "components": self._foreground.components(index),
            "foreground": self._foreground.foregrounds(index),
        }
        return self._nodes.add("proposals", inputs)

    def _track_objects(self, index: int) -> str:
        """A section's objects from the masks of its first frame on."""
        section = self._sections[index]
        frames = self._leaves.frames[section.start : self.labelled_until(index)]
        return self._nodes.add("proposals", {"frames": frames, "seeds": self._seeds(index)})

    def _seeds(self, index: int) -> str:
        """What is found in a section's first frame, linked with what was tracked into it."""
        inputs = {"found": self._instances(self._sections[index].start)}
        if index:
            inputs["tracked"] = self.proposals(index - 1)
        return self._nodes.add("seeds", inputs)

    def _instances(self, frame: int) -> str:
        """Reference of the objects that the networks find in one frame."""
        image = self._leaves.frames[frame]
        return self._nodes.add("instances", {"frame": image, "detections": self._detections(image)})

    def _detections(self, image: str) -> str:
        inputs = {"frame": image}
        if self._config.detections.tags is None:
            inputs["tags"] = self._nodes.add("tags", {"frame": image})
        return self._nodes.add("detections", inputs)
