"""Motions: point tracks, motion models of every object, and the affinity between objects under each model."""

from collections.abc import Iterator

from moseg.tasks.motion_models import FLOW_MODELS
from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.objects import Objects
from moseg.workflows.graph.sections import Section
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES
from moseg.workflows.stages.affinity import BY_HYPOTHESES


class Motions:
    """Writer of the recipes from cues and objects to affinities."""

    def __init__(self, nodes: Nodes, cues: FrameCues, objects: Objects, sections: tuple[Section, ...]):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves
        self._cues = cues
        self._objects = objects
        self._sections = sections

    @cached_method
    def affinity(self, view: str) -> str:
        """Return the reference of the objects' affinity under one motion model."""
        method = self._config.affinity.method
        inputs = {}
        if method != "hypotheses":
            inputs["residuals"] = self.residuals(view)
        if method in BY_HYPOTHESES:
            inputs["hypotheses"] = self.hypotheses(view)
        return self._nodes.add("affinity", inputs, view=view)

    @cached_method
    def residuals(self, view: str) -> tuple[str, ...]:
        """Return the references of the residuals of all sections' frame pairs under the objects' models of one kind."""
        if view == "trajs":
            return tuple(self._fundamental_residual(*pairs) for pairs in self._pairs())
        return tuple(self._flow_residual(index, num_pairs, view) for index, num_pairs in self._flow_pairs())

    @cached_method
    def hypotheses(self, view: str) -> tuple[str, ...]:
        """Return the references of the residuals of all sections' frame pairs under many hypotheses of one model."""
        if view == "trajs":
            return tuple(self._track_hypotheses(*pairs) for pairs in self._pairs())
        return tuple(self._flow_hypotheses(index, num_pairs, view) for index, num_pairs in self._flow_pairs())

    @cached_method
    def tracks(self, index: int) -> str:
        """Return the reference of a section's point tracks, which go on into the next section as far as a pair does."""
        section = self._sections[index]
        stop = min(section.stop + self._gap(index), len(self._nodes.frames))
        proposals = self._objects.proposals(index)
        if self._config.tracks.method in GIVEN_SOURCES:
            given = self._nodes.required("tracks", f"tracks: {self._config.tracks.method}")
            inputs = {"tracks": given, "proposals": proposals}
            return self._nodes.add("tracks", inputs, start=section.start, stop=stop)
        inputs = {"frames": self._nodes.frames[section.start : stop], "proposals": proposals}
        num_frames = min(self._objects.labelled_until(index), stop) - section.start
        return self._nodes.add("tracks", inputs, num_frames=num_frames)

    @cached_method
    def rigid_supports(self) -> tuple[str, ...]:
        """Return the references of the rigid support of the objects of the sections that are compared with a scene."""
        compared = filter(self._objects.is_compared, range(len(self._sections)))
        return tuple(map(self._rigid_support, compared))

    def _rigid_support(self, index: int) -> str:
        objects, window = self._objects, self._objects.track_proposals
        inputs = {"proposals": objects.proposals(index), "linking": objects.linking()}
        if objects.source_of(index) == "tracks":
            return self._nodes.add("rigid_support", inputs, "tracks", section=index)
        pairs = self._config.rigid_support.step, self._rigid_gap(index)
        inputs |= {
            "dense_tracks": window.dense_tracks(index, *pairs),
            "rigidity": window.rigidity(index, *pairs),
        }
        place = {"section": index, "start": window.first_row(index), **self._leaves.picture()}
        return self._nodes.add("rigid_support", inputs, "masks", **place, min_gain=objects.min_gain(index))

    def _gap(self, index: int) -> int:
        """Return how many frames apart the tracks of a section are compared: farther where motion is slow.

        But not farther than its objects are known in the next section.
        """
        gap = self._config.fundamental.gap
        return max(min(gap * self._picture_gap(index), self._config.sections.overlap), gap)

    def _rigid_gap(self, index: int) -> int:
        """Return how many times as far apart the frames are over which a section is compared with a rigid scene.

        Half of its window has such pairs. Cameras by a network are those of the usual pairs.
        """
        first, last = self._objects.track_proposals.window(index)
        if self._config.cameras.method != "tracks":
            return 1
        return max(min(self._picture_gap(index), (last - first) // (2 * max(self._config.rigidity.gaps))), 1)

    def _picture_gap(self, index: int) -> int:
        return self._cues.pictures.gap_of(self._sections[index])

    def _pairs(self) -> Iterator[tuple[int, int, int]]:
        """Yield, for every section with frame pairs, its index, the number of pairs, and their gap in frames."""
        num_frames = len(self._nodes.frames)
        for index, section in enumerate(self._sections):
            gap = min(self._gap(index), num_frames - 1)
            num_pairs = min(section.stop, num_frames - gap) - section.start
            if num_pairs > 0:
                yield index, num_pairs, gap

    def _flow_pairs(self) -> Iterator[tuple[int, int]]:
        """Yield, for every section with frames that another picture follows, its index and how many these are."""
        for index, section in enumerate(self._sections):
            num_pairs = min(section.stop, self._cues.pictures.num_followed) - section.start
            if num_pairs > 0:
                yield index, num_pairs

    def _fundamental_residual(self, index: int, num_pairs: int, gap: int) -> str:
        cues = {"tracks": self.tracks(index), "linking": self._objects.linking()}
        place = {"section": index, "num_pairs": num_pairs, "gap": gap}
        fits = self._nodes.add("fundamental", cues, **place, shape=self._leaves.shape)
        return self._nodes.add("fundamental_residual", {"fits": fits, **cues}, **place)

    def _track_hypotheses(self, index: int, num_pairs: int, gap: int) -> str:
        place = {"section": index, "num_pairs": num_pairs, "gap": gap, "shape": self._leaves.shape}
        inputs = {"tracks": self.tracks(index), "linking": self._objects.linking()}
        return self._nodes.add("object_hypotheses", inputs, "track-samples", **place)

    def _flow_hypotheses(self, index: int, num_pairs: int, model: str) -> str:
        inputs = self._flow_inputs(index, num_pairs, model)
        return self._nodes.add("object_hypotheses", inputs, "flow-patches", section=index, model=model)

    def _flow_residual(self, index: int, num_pairs: int, model: str) -> str:
        fits = self._nodes.add("flow_model", self._flow_inputs(index, num_pairs, model), section=index, model=model)
        return self._nodes.add("flow_residual", {"fits": fits})

    def _flow_inputs(self, index: int, num_pairs: int, model: str) -> dict:
        start = self._sections[index].start
        frames = range(start, start + num_pairs)
        inputs = {
            "flow": tuple(map(self._cues.flow_to_next, frames)),
            "proposals": self._objects.proposals(index),
            "linking": self._objects.linking(),
        }
        if FLOW_MODELS[model].uses_depth and self._config.depth.method != "none":
            inputs["depth"] = tuple(self._cues.depth(frame) for frame in frames)
        return inputs
