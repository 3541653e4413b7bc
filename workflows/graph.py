"""The graph of a sequence: from a sink back to the decoded frames, every node a recipe.

A `SequenceGraph` only writes recipes; it neither looks into the store nor computes. The same node asked for twice is
the same recipe, whichever variant or run asks.
"""

from collections.abc import Mapping, Set
from typing import NamedTuple

from schemas.configs import PipelineConfig, Variant
from schemas.errors import InputError
from schemas.frozen import Frozen
from schemas.recipes import Recipe
from workflows.sections import cut_sections
from workflows.stages.registry import find_task
from workflows.weights.needed import tagger_item

GIVEN_SOURCES = ("groundtruth", "folder")
LUCAS_KANADE_PARAMS = {"window", "pyramid_levels", "forward_backward"}


class SequenceLeaves(NamedTuple):
    """A sequence after ingest: references of its decoded content, and what the graph must know of it.

    Attributes
    ----------
    name : str
    shape : (int, int)
        Height and width of the frames as analysed, px.
    frames : tuple of references
    annotation : reference or None
        Ground truth.
    void : int or None
        Annotated label that counts for neither side.
    num_motions : int or None
        True number of motions, the background's included.
    masks, tracks : reference or None
        Given proposals and point tracks of the whole sequence.
    masks_void : int or None
        Label of the given proposals that is no object.
    depth, flow_forward, flow_backward : tuple of references or None
        Given cues, one a frame or a frame pair.
    weights : dict of str to reference
        The weights that the configuration's networks read, by name of their item.
    """

    name: str
    shape: tuple[int, int]
    frames: tuple[str, ...]
    annotation: str | None = None
    void: int | None = None
    num_motions: int | None = None
    masks: str | None = None
    masks_void: int | None = None
    tracks: str | None = None
    depth: tuple[str, ...] | None = None
    flow_forward: tuple[str, ...] | None = None
    flow_backward: tuple[str, ...] | None = None
    weights: Mapping[str, str] = {}


class SequenceGraph:
    """Writes the recipes of one sequence under one configuration."""

    def __init__(self, leaves: SequenceLeaves, config: PipelineConfig):
        self.recipes: dict[str, Recipe] = {}
        self.leaves = leaves
        self._config = config
        self._sections = cut_sections(len(leaves.frames), config.sections)
        self._proposals: list[str] = []
        self._tracks: dict[int, str] = {}
        self._linking: str | None = None

    def score(self, variant: Variant) -> str:
        """Reference of the variant's score."""
        if self.leaves.annotation is None:
            raise InputError("no ground truth to score against", where=f"sequence {self.leaves.name}")
        return self._node(
            "score",
            "motion-segmentation",
            {"void": self.leaves.void, "section_length": self._config.sections.length},
            {"segmentation": self.segmentations(variant), "annotation": self.leaves.annotation},
        )

    def segmentations(self, variant: Variant) -> tuple[str, ...]:
        """References of the labels of every section."""
        clustering = self.clustering(variant)
        refs = []
        for index, section in enumerate(self._sections):
            inputs = {"proposals": self.proposals(index), "linking": self.linking()}
            if clustering is not None:
                inputs["clustering"] = clustering
            params = {"section": index, "num_frames": section.stop - section.start}
            refs.append(self._node("segmentation", "moving-objects", params, inputs))
        return tuple(refs)

    def clustering(self, variant: Variant) -> str | None:
        """Reference of the motion groups; None for the variant that keeps every proposal."""
        views = self._config.views(variant)
        if not views:
            return None
        params = self._config.clustering
        num_motions = params.motions
        if num_motions == "gt":
            num_motions = self.leaves.num_motions
            if num_motions is None:
                raise InputError(
                    "the number of motions is not known",
                    where=f"sequence {self.leaves.name}",
                    got="--motions gt without ground truth",
                    expected="--motions auto or a number",
                )
        return self._node(
            "clustering",
            "motion-groups",
            {
                "num_motions": None if num_motions == "auto" else num_motions,
                "clustering": self._clustering_params(len(views), num_motions == "auto"),
            },
            {"affinities": tuple(self.affinity(view) for view in views)},
        )

    def _clustering_params(self, num_views: int, is_auto: bool) -> dict:
        """The parameters that a clustering of so many views reads."""
        params = self._config.clustering
        unread = {"motions"}
        if not is_auto:
            unread |= {"auto", "threshold"}
        elif params.auto != "threshold":
            unread.add("threshold")
        if num_views == 1 or params.fusion != "coregularised":
            unread |= {"co_regularisation", "num_iterations", "tolerance"}
        if num_views == 1:
            unread.add("fusion")
        return params.model_dump(mode="json", exclude=unread)

    def affinity(self, view: str) -> str:
        """Reference of the objects' affinity under one motion model."""
        params = self._config.affinity
        is_flow = view != "trajs"
        unread = {"method"} if is_flow else {"method", "relative_flow"}
        read = {
            name: value
            for name, value in params.model_dump(mode="json", exclude=unread).items()
            if name.startswith("ork") == (params.method == "ork")
        }
        residuals = self.residuals(view)
        return self._node("affinity", params.method, {"is_flow": is_flow, "affinity": read}, {"residuals": residuals})

    def residuals(self, view: str) -> tuple[str, ...]:
        """References of the residuals of every section's frame pairs under one motion model."""
        num_frames = len(self.leaves.frames)
        gap = min(self._config.fundamental.gap, num_frames - 1) if view == "trajs" else 1
        refs = []
        for index, section in enumerate(self._sections):
            num_pairs = min(section.stop, num_frames - gap) - section.start
            if num_pairs > 0:
                refs.append(
                    self._fundamental_residual(index, num_pairs, gap)
                    if view == "trajs"
                    else self._flow_residual(index, num_pairs, view)
                )
        return tuple(refs)

    def cues(self) -> tuple[str, ...]:
        """References of the tracks and of the forward flow: what every motion model starts from."""
        flows = (self.flow(frame, frame + 1) for frame in range(len(self.leaves.frames) - 1))
        return (*(self.tracks(index) for index in range(len(self._sections))), *flows)

    def proposals(self, index: int) -> str:
        """Reference of a section's object proposals."""
        # In order, because a section starts with what was tracked into it.
        while len(self._proposals) <= index:
            self._proposals.append(self._propose(len(self._proposals)))
        return self._proposals[index]

    def linking(self) -> str:
        """Reference of the identities of the sections' objects."""
        if self._linking is None:
            self._linking = self._link()
        return self._linking

    def tracks(self, index: int) -> str:
        """Reference of a section's point tracks; they reach `gap` frames into the next section."""
        if index not in self._tracks:
            self._tracks[index] = self._track(index)
        return self._tracks[index]

    def _propose(self, index: int) -> str:
        section = self._sections[index]
        if self._config.proposal_source in GIVEN_SOURCES:
            masks = self._required("masks", f"proposals: {self._config.proposal_source}")
            params = {"start": section.start, "stop": section.proposal_stop, "shape": list(self.leaves.shape)}
            params["void"] = self.leaves.masks_void
            return self._node("proposals", "given", params, {"masks": masks})
        if self._config.proposal_source == "detections":
            return self._track_objects(index)
        saliency = tuple(self.saliency(frame) for frame in range(section.context_start, section.context_stop))
        return self._node(
            "proposals",
            "saliency",
            {
                "first": section.start - section.context_start,
                "last": section.proposal_stop - section.context_start,
                "shape": list(self.leaves.shape),
                "proposals": self._config.proposals.model_dump(mode="json"),
            },
            {"saliency": saliency},
        )

    def _link(self) -> str:
        proposals = tuple(self.proposals(index) for index in range(len(self._sections)))
        if self._config.proposal_source != "saliency":
            return self._node("linking", "identity", {}, {"proposals": proposals})
        params = {
            "lengths": [section.stop - section.start for section in self._sections],
            "linking": self._config.linking.model_dump(mode="json"),
        }
        return self._node("linking", "overlap", params, {"proposals": proposals})

    def _track_objects(self, index: int) -> str:
        """A section's objects from the masks of its first frame on."""
        section = self._sections[index]
        frames = self.leaves.frames[section.start : self._proposal_stop(index)]
        tracker = self._config.detections.tracker
        params, weights = self._network(tracker, unread={"boxes_per_pass"})
        inputs = {"frames": frames, "seeds": self._seeds(index), "weights": weights}
        return self._node("proposals", tracker, params, inputs)

    def _seeds(self, index: int) -> str:
        """What is found in a section's first frame, linked with what was tracked into it."""
        inputs = {"found": self.instances(self._sections[index].start)}
        if index:
            inputs["tracked"] = self.proposals(index - 1)
        params = {"seeds": self._config.seeds.model_dump(mode="json")}
        return self._node("seeds", "mask-overlap", params, inputs)

    def instances(self, frame: int) -> str:
        """Reference of the objects that the networks find in one frame."""
        image, masks = self.leaves.frames[frame], self._config.detections.masks
        params, weights = self._network(masks, unread={"objects_per_pass", "memory_reach"})
        params["instances"] = self._config.instances.model_dump(mode="json")
        inputs = {"frame": image, "detections": self._detections(image), "weights": weights}
        return self._node("instances", masks, params, inputs)

    def _detections(self, image: str) -> str:
        params, weights = self._network("grounding-dino")
        inputs = {"frame": image, "weights": weights}
        if self._config.detections.tags is not None:
            params["tags"] = list(self._config.detections.tags)
        else:
            inputs["tags"] = self._tags(image)
        return self._node("detections", "grounding-dino", params, inputs)

    def _tags(self, image: str) -> str:
        params = {"ram": self._config.ram.model_dump(mode="json", exclude={"weights"})}
        inputs = {"frame": image, "weights": self._weights(tagger_item(self._config))}
        return self._node("tags", self._config.detections.tagger, params, inputs)

    def _proposal_stop(self, index: int) -> int:
        """End of the frames in which a section's objects are labelled."""
        section = self._sections[index]
        if self._config.proposal_source == "detections":
            # The next section takes up what was tracked into its first frame.
            return min(section.stop + 1, len(self.leaves.frames))
        return section.proposal_stop

    def saliency(self, frame: int) -> str:
        """Reference of a frame's motion saliency."""
        frames = self.leaves.frames
        inputs = {"frame": frames[frame]}
        if frame > 0:
            inputs |= {"previous": frames[frame - 1], "flow_previous": self.flow(frame, frame - 1)}
        if frame + 1 < len(frames):
            inputs |= {"next": frames[frame + 1], "flow_next": self.flow(frame, frame + 1)}
        return self._node("saliency", "background-residual", self._config.saliency.model_dump(mode="json"), inputs)

    def flow(self, frame0: int, frame1: int) -> str:
        """Reference of the flow from one frame to a neighbour."""
        params = self._config.flow
        if params.method in GIVEN_SOURCES:
            direction = "flow_forward" if frame1 > frame0 else "flow_backward"
            return self._required(direction, f"flow: {params.method}")[min(frame0, frame1)]
        inputs = {"frame0": self.leaves.frames[frame0], "frame1": self.leaves.frames[frame1]}
        if params.method == "dis":
            return self._node("flow", "dis", params.model_dump(mode="json", exclude={"method"}), inputs)
        read, weights = self._network(params.method)
        return self._node("flow", params.method, read, {**inputs, "weights": weights})

    def depth(self, frame: int) -> str:
        """Reference of a frame's inverse depth."""
        method = self._config.depth.method
        if method in GIVEN_SOURCES:
            return self._required("depth", f"depth: {method}")[frame]
        params, weights = self._network(method)
        return self._node("depth", method, params, {"frame": self.leaves.frames[frame], "weights": weights})

    def _track(self, index: int) -> str:
        section = self._sections[index]
        stop = min(section.stop + self._config.fundamental.gap, len(self.leaves.frames))
        params = self._config.tracks
        if params.method in GIVEN_SOURCES:
            given = self._required("tracks", f"tracks: {params.method}")
            inputs = {"tracks": given, "proposals": self.proposals(index)}
            return self._node("tracks", "given", {"start": section.start, "stop": stop}, inputs)
        inputs = {"frames": self.leaves.frames[section.start : stop], "proposals": self.proposals(index)}
        read = {"num_frames": min(self._proposal_stop(index), stop) - section.start}
        unread = {"method"}
        if params.method != "lucas-kanade":
            unread |= LUCAS_KANADE_PARAMS
            network, inputs["weights"] = self._network(params.method)
            read |= network
        read["tracks"] = params.model_dump(mode="json", exclude=unread)
        return self._node("tracks", params.method, read, inputs)

    def _fundamental_residual(self, index: int, num_pairs: int, gap: int) -> str:
        cues = {"tracks": self.tracks(index), "linking": self.linking()}
        pairs = {"section": index, "num_pairs": num_pairs, "gap": gap}
        params = self._config.fundamental.model_dump(mode="json", exclude={"gap"})
        fitted = {name: value for name, value in params.items() if name != "statistic"}
        fit = {**pairs, "shape": list(self.leaves.shape), "fundamental": fitted}
        fits = self._node("fundamental", "ransac", fit, cues)
        read = {name: params[name] for name in ("statistic", "min_points")}
        return self._node("fundamental_residual", "sampson", {**pairs, "fundamental": read}, {"fits": fits, **cues})

    def _flow_residual(self, index: int, num_pairs: int, model: str) -> str:
        start = self._sections[index].start
        frames = range(start, start + num_pairs)
        inputs = {
            "flow": tuple(self.flow(frame, frame + 1) for frame in frames),
            "proposals": self.proposals(index),
            "linking": self.linking(),
        }
        if model != "oc" and self._config.depth.method != "none":
            inputs["depth"] = tuple(self.depth(frame) for frame in frames)
        params = {"section": index, "model": model, "flow_model": self._config.flow_model.model_dump(mode="json")}
        fits = self._node("flow_model", "least-squares", params, inputs)
        return self._node("flow_residual", "mean-squared-error", {}, {"fits": fits})

    def _network(self, method: str, unread: Set[str] = frozenset()) -> tuple[dict, str]:
        """The parameters that a network reads, under its name, and its weights; `unread` are of its other uses."""
        name = method.replace("-", "_")
        params: Frozen = getattr(self._config, name)
        return {name: params.model_dump(mode="json", exclude={"weights", *unread})}, self._weights(params.weights)

    def _weights(self, item: str) -> str:
        return self.leaves.weights[item]

    def _required(self, leaf: str, option: str):
        value = getattr(self.leaves, leaf)
        if value is None:
            raise InputError(
                f"{option} needs {leaf.replace('_', ' ')} that the data set does not give",
                where=f"sequence {self.leaves.name}",
            )
        return value

    def _node(self, name: str, method: str, params: dict, inputs: dict) -> str:
        task = find_task(name, method)
        recipe = Recipe(task=name, version=task.version, params={"method": method, **params}, inputs=inputs)
        self.recipes[recipe.ref] = recipe
        return recipe.ref
