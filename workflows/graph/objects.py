"""Objects: proposals of every section, and their identities over the sequence."""

from moseg.schemas.configs import BY_CAMERA, MOTION_SOURCES, TRACKED_SOURCES
from moseg.schemas.stretch_choice import StretchChoice
from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.foreground import Foreground
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.sections import Section
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES
from moseg.workflows.graph.track_proposals import TrackProposals


class Objects:
    """Writer of the recipes of the objects of every section.

    Attributes
    ----------
    track_proposals : TrackProposals
    """

    def __init__(self, nodes: Nodes, cues: FrameCues, foreground: Foreground, sections: tuple[Section, ...]):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves
        self._foreground = foreground
        self._sections = sections
        self.track_proposals = TrackProposals(nodes, cues, sections)
        self._proposals: list[str] = []

    def proposals(self, index: int) -> str:
        """Return the reference of a section's object proposals."""
        # In order, because a section starts with the objects that were tracked into it.
        while len(self._proposals) <= index:
            self._proposals.append(self._inside(self._propose(len(self._proposals))))
        return self._proposals[index]

    @cached_method
    def linking(self) -> str:
        """Return the reference of the identities of the sections' objects."""
        proposals = tuple(self.proposals(index) for index in range(len(self._sections)))
        if self._config.proposal_source not in MOTION_SOURCES:
            return self._nodes.add("linking", {"proposals": proposals})
        lengths = [section.stop - section.start for section in self._sections]
        inputs = {"proposals": proposals}
        seen = [index for index in range(len(self._sections)) if self.source_of(index) == "saliency"]
        if not self._config.identity.return_gap:
            seen = []
        if seen:
            inputs["sightings"] = tuple(self._sightings(index) for index in seen)
        return self._nodes.add("linking", inputs, lengths=lengths, seen=seen)

    def _sightings(self, index: int) -> str:
        """Return the reference of where a section's objects of saliency begin and end."""
        section = self._sections[index]
        inputs = {
            "components": self._foreground.components(index),
            "frames": self._nodes.frames[section.start : section.proposal_stop],
            "saliency": self._foreground.steps(section.start, section.proposal_stop),
        }
        return self._nodes.add("sightings", inputs)

    def source_of(self, index: int) -> str:
        """Return the source of a section's proposals; saliency if it was left open and not chosen."""
        return self._config.proposal_source if self._is_prompted else self.regions_of(index)

    def regions_of(self, index: int) -> str:
        """Return where a section's moving regions come from, which prompt networks or are the proposals themselves.

        Proposals that are not made from motion have no such regions; their source is returned.
        """
        if self._config.proposal_source not in BY_CAMERA:
            return self._config.proposal_source
        choice = self._choice_of(index)
        return "saliency" if choice is None else choice.proposals

    @property
    def _is_prompted(self) -> bool:
        return self._config.proposal_source == "motion-prompts"

    def is_compared(self, index: int) -> bool:
        """Return whether a section's objects are compared with a rigid scene."""
        use = self._config.rigid_support.use
        if use != "auto":
            return use == "always"
        if self.regions_of(index) == "tracks":
            return True
        choice = self._choice_of(index)
        return choice is not None and choice.shows_depth

    def min_gain(self, index: int) -> float:
        """Return the gain that the surroundings of a section's objects need for these to be part of a rigid scene.

        It is what the stretch needed with the objects, and 0 where no stretch was judged or all are compared.
        """
        choice, params = self._choice_of(index), self._config.scene_parallax
        if choice is None or self._config.rigid_support.use == "always":
            return 0.0
        is_ahead = choice.proposals == "tracks" or choice.gain < params.min_gain
        return params.min_ahead_gain if is_ahead else params.min_gain

    def _choice_of(self, index: int) -> StretchChoice | None:
        """Return the choice of the stretch that a section lies in; None if none was made."""
        section = self._sections[index]
        middle = (section.start + section.stop - 1) // 2
        holding = (choice for choice in self._leaves.choices if choice.first_frame <= middle <= choice.last_frame)
        return next(holding, None)

    @property
    def uses_saliency(self) -> bool:
        """Return whether the moving regions of any section come from saliency, which then covers the whole video."""
        return any(self.regions_of(index) == "saliency" for index in range(len(self._sections)))

    def labelled_until(self, index: int) -> int:
        """Return the end of the frames in which a section's objects are labelled."""
        section = self._sections[index]
        if self._config.proposal_source in TRACKED_SOURCES:
            # The next section continues the objects that were tracked into its first frame.
            return min(section.stop + 1, len(self._nodes.frames))
        if self.source_of(index) == "tracks":
            return self.track_proposals.window(index).last
        return section.proposal_stop

    def _inside(self, proposals: str) -> str:
        """Return the reference of a section's objects without what lies in black bars; as they are without bars."""
        bars = self._leaves.bars
        return (
            proposals if bars is None else self._nodes.add("proposals", {"proposals": proposals}, "inside", bars=bars)
        )

    def _propose(self, index: int) -> str:
        section = self._sections[index]
        if self._config.proposal_source in GIVEN_SOURCES:
            masks = self._nodes.required("masks", f"proposals: {self._config.proposal_source}")
            place = {"start": section.start, "stop": section.proposal_stop}
            given = {"shape": self._leaves.shape, "void": self._leaves.masks_void}
            return self._nodes.add("proposals", {"masks": masks}, **place, **given)
        if self._config.proposal_source in TRACKED_SOURCES:
            return self._track_objects(index)
        return self._regions(index)

    @cached_method
    def _regions(self, index: int) -> str:
        """Return the reference of the masks of a section's moving regions."""
        section = self._sections[index]
        if self.regions_of(index) == "tracks":
            return self.track_proposals.proposals(index)
        frames = self._nodes.frames[section.start : section.proposal_stop]
        inputs = {
            "frames": frames,
            "components": self._foreground.components(index),
            "foreground": self._foreground.foregrounds(index),
        }
        return self._nodes.add("proposals", inputs, "saliency")

    def _track_objects(self, index: int) -> str:
        """Return the reference of a section's objects, tracked from the masks of its first frame."""
        section = self._sections[index]
        frames = self._nodes.frames[section.start : self.labelled_until(index)]
        return self._nodes.add("proposals", {"frames": frames, "seeds": self._seeds(index)})

    def _seeds(self, index: int) -> str:
        """Return the reference of the objects of a section's first frame, linked with those tracked into it."""
        start = self._sections[index].start
        inputs = {"found": self._prompted(index) if self._is_prompted else self._instances(start)}
        if index:
            inputs["tracked"] = self.proposals(index - 1)
        return self._nodes.add("seeds", inputs)

    def motion_prompts(self, index: int) -> str:
        """Return the reference of the prompts that moving regions give in a section's first frame."""
        return self._nodes.add("motion_prompts", {"regions": self._inside(self._regions(index))})

    def _prompted(self, index: int) -> str:
        """Return the reference of the objects that moving regions prompt in a section's first frame."""
        frame = self._nodes.frames[self._sections[index].start]
        return self._nodes.add("instances", {"frame": frame, "prompts": self.motion_prompts(index)})

    def _instances(self, frame: int) -> str:
        """Return the reference of the objects that the networks find in one frame."""
        image = self._nodes.frames[frame]
        if self._config.proposal_source == "sam3":
            return self._nodes.add("instances", {"frame": image})
        return self._nodes.add("instances", {"frame": image, "detections": self._detections(image)})

    def _detections(self, image: str) -> str:
        inputs = {"frame": image}
        if self._config.detections.tags is None:
            inputs["tags"] = self._nodes.add("tags", {"frame": image})
        return self._nodes.add("detections", inputs)
