"""The sinks of a sequence's graph: scores, labels and motion groups of every variant.

A `SequenceGraph` only writes recipes; it neither reads the store nor computes. A node has the same recipe in every
variant and run that needs it.
"""

from collections.abc import Mapping, MutableMapping
from copy import copy

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.corrections import Drop, Rename, Static
from moseg.schemas.errors import InputError
from moseg.schemas.parameters.clustering import READ_TRACKS
from moseg.schemas.recipes import Recipe
from moseg.workflows.graph.black_bars import black_bars
from moseg.workflows.graph.foreground import Foreground
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.motions import Motions
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.objects import Objects
from moseg.workflows.graph.painted_sections import PaintedSections
from moseg.workflows.graph.scene_cuts import SceneCuts, scene_cuts
from moseg.workflows.graph.screen_graphics import screen_graphics
from moseg.workflows.graph.sections import cut_sections, place_frame
from moseg.workflows.graph.sequence_leaves import SequenceLeaves

LAST_STAGES = {"affinity", "clustering", "moving_objects", "moves_now", "confidence"}
"""Stages whose parameters change nothing in the recipes of objects and of their motion models."""


class SequenceGraph:
    """Writer of the recipes of one sequence under one configuration.

    Parameters
    ----------
    leaves : SequenceLeaves
    config : PipelineConfig
    recipes : mapping of reference to Recipe, optional
        Those of the graph that this is the graph of a scene of.

    Attributes
    ----------
    leaves : SequenceLeaves
    frame_cues : FrameCues
    foreground : Foreground
    objects : Objects
    motions : Motions
    sections : tuple of Section
    """

    def __init__(
        self,
        leaves: SequenceLeaves,
        config: PipelineConfig,
        recipes: MutableMapping[str, Recipe] | None = None,
    ):
        # Nodes of the last stages, of the motions, and of what lies before both.
        self._nodes = self._motion_nodes = self._first_nodes = Nodes(leaves, config, recipes)
        self._config = config
        self.leaves = leaves
        self.sections = cut_sections(len(leaves.frames), config.sections)
        self.frame_cues = FrameCues(self._nodes)
        self.foreground = Foreground(self._nodes, self.frame_cues, self.sections)
        self.objects = Objects(self._nodes, self.frame_cues, self.foreground, self.sections)
        self.motions = Motions(self._nodes, self.frame_cues, self.objects, self.sections)
        self._painted = PaintedSections(self._nodes, self.frame_cues, self.sections, (range(len(self.sections)),))

    def changed(
        self,
        leaves: SequenceLeaves,
        config: PipelineConfig,
        recipes: MutableMapping[str, Recipe] | None = None,
    ) -> "SequenceGraph":
        """Return the graph of other leaves and another configuration, with what they have in common not written again.

        That is most of it if nothing changes but edits, and parameters of the stages of `LAST_STAGES`.
        """
        names = type(config).model_fields
        moved = {name for name in names if getattr(config, name) != getattr(self._config, name)}
        if not moved <= LAST_STAGES or leaves._replace(edits=()) != self.leaves._replace(edits=()):
            return type(self)(leaves, config, recipes)
        graph, keeps_motions = copy(self), "affinity" not in moved
        nodes = self._motion_nodes if keeps_motions else self._first_nodes
        graph._write_on(nodes.changed(leaves, config, recipes), keeps_motions)
        return graph

    def _write_on(self, nodes: Nodes, keeps_motions: bool) -> None:
        """Write what follows on other nodes, the motions too if they are not kept."""
        self._nodes, self._config, self.leaves = nodes, nodes.config, nodes.leaves
        if not keeps_motions:
            self._motion_nodes = nodes
            self.motions = Motions(nodes, self.frame_cues, self.objects, self.sections)
        self._painted = PaintedSections(nodes, self.frame_cues, self.sections, (range(len(self.sections)),))

    @property
    def scenes(self) -> tuple["SequenceGraph", ...]:
        """The graph of each scene, which is this one where there is a single scene."""
        return (self,)

    @property
    def first_frames(self) -> tuple[int, ...]:
        """The first frame of each scene."""
        return (0,)

    def place(self, frame: int) -> tuple[int, int]:
        """Return the section that a frame belongs to, and its row there."""
        return place_frame(self.sections, frame)

    @property
    def recipes(self) -> Mapping[str, Recipe]:
        """Recipes written so far, by reference."""
        return self._nodes.recipes

    def score(self, variant: Variant) -> str:
        """Return the reference of the variant's score."""
        leaves, labels = self.leaves, {"segmentation": self.segmentations(variant)}
        if leaves.annotation is not None:
            inputs = {**labels, "annotation": leaves.annotation}
            return self._nodes.add("score", inputs, "motion-segmentation", void=leaves.void)
        if leaves.labelled_points is not None:
            return self._nodes.add("score", {**labels, "labelled_points": leaves.labelled_points}, "labelled-points")
        if leaves.nothing_moves:
            return self._nodes.add("score", labels, "still")
        raise InputError("no ground truth to score against", where=f"sequence {leaves.name}")

    def segmentations(self, variant: Variant) -> tuple[str, ...]:
        """Return the references of the labels of all sections."""
        return self._label(variant, self.corrected_objects(variant))

    def _label(self, variant: Variant, corrected: str | None) -> tuple[str, ...]:
        """Return the references of the labels of all sections, of corrected objects where they are given."""
        clustering, refs = self.clustering(variant), []
        for index, section in enumerate(self.sections):
            inputs = {"proposals": self.objects.proposals(index), "linking": self.objects.linking()}
            place = {"section": index, "num_frames": section.stop - section.start}
            if corrected is not None:
                inputs["corrected"] = corrected
                painted = self.painted(index)
                if painted is not None:
                    inputs["painted"] = painted
                refs.append(self._nodes.add("segmentation", inputs, "corrected", **place, start=section.start))
                continue
            if clustering is not None:
                inputs["clustering"] = clustering
            refs.append(self._nodes.add("segmentation", inputs, **place))
        return tuple(refs)

    def corrected_objects(self, variant: Variant) -> str | None:
        """Return the reference of the objects after the user's edits, without small ones.

        None if nothing but names is edited, and no object is too small.
        """
        edits, areas = self.leaves.edits, self.object_areas()
        if not areas and all(isinstance(edit, Rename) for edit in edits):
            return None
        inputs, clustering = {"linking": self.objects.linking()}, self.clustering(variant)
        if clustering is not None:
            inputs["clustering"] = clustering
        if areas:
            inputs["areas"] = areas
        return self._nodes.add("corrected_objects", inputs, edits=edits, num_frames=len(self.leaves.frames))

    def object_areas(self) -> tuple[str, ...]:
        """Return the references of how large the objects of all sections become; none if none is too small."""
        if not self._config.moving_objects.min_area:
            return ()
        return tuple(
            self._nodes.add(
                "object_areas", {"proposals": self.objects.proposals(index)}, num_frames=section.stop - section.start
            )
            for index, section in enumerate(self.sections)
        )

    def painted(self, index: int) -> str | None:
        """Return the reference of what the user painted, erased and added in a section; None if nothing did."""
        return self._painted.painted(index)

    def _judged(self, variant: Variant) -> tuple[tuple[str, ...], dict[str, str]]:
        """Return the labels in which objects are judged, and the input that tells how many identities they have.

        Objects that are only left out change nothing in what is known of the others, so nothing is computed again.
        """
        corrected = self.corrected_objects(variant)
        if corrected is None or all(isinstance(edit, Drop | Static | Rename) for edit in self.leaves.edits):
            return self._label(variant, None), {"linking": self.objects.linking()}
        return self._label(variant, corrected), {"corrected": corrected}

    def black_bars(self) -> str:
        """Return the reference of the black bars of the sequence."""
        return black_bars(self._first_nodes)

    def screen_graphics(self) -> str:
        """Return the reference of the graphics that were drawn into the frames of the sequence."""
        return screen_graphics(self._first_nodes)

    def scene_cuts(self) -> tuple[SceneCuts, ...]:
        """Return the cuts of each stretch of the sequence."""
        return scene_cuts(self._first_nodes)

    def moves_now(self, variant: Variant) -> tuple[str | None, ...]:
        """Return the references of whether objects move now, one a section; None where saliency is not read."""
        refs = []
        judged, counted = self._judged(variant)
        for index, (section, labels) in enumerate(zip(self.sections, judged, strict=True)):
            if self.objects.regions_of(index) != "saliency":
                refs.append(None)
                continue
            saliency = self.foreground.saliency(section.start, section.stop)
            inputs = {"segmentation": labels, **counted, "saliency": saliency}
            pictures = self.frame_cues.pictures
            place: dict = pictures.ends_in(section.start, section.stop)
            shares = [pictures.shares(frame)["previous"] for frame in range(section.start, section.stop)]
            if set(shares) != {1.0}:
                place["previous"] = shares
            refs.append(self._nodes.add("moves_now", inputs, **place))
        return tuple(refs)

    def confidences(self, variant: Variant) -> tuple[str | None, ...]:
        """Return the references of how sure and complete objects are, one a section; None without a foreground."""
        refs = []
        judged, counted = self._judged(variant)
        for index, labels in enumerate(judged):
            if self.objects.source_of(index) != "saliency":
                refs.append(None)
                continue
            foreground = self.foreground.foreground(index)
            inputs = {"segmentation": labels, **counted, "foreground": foreground}
            refs.append(self._nodes.add("confidence", inputs))
        return tuple(refs)

    def clustering(self, variant: Variant) -> str | None:
        """Return the reference of the motion groups; None for the variant that keeps every proposal."""
        views = self._config.views(variant)
        if not views:
            return None
        params = self._config.clustering
        num_motions = params.motions
        if num_motions == "gt" and self.leaves.nothing_moves:
            raise InputError(
                "nothing moves: the true number of motions, 1, is the result itself",
                where=f"sequence {self.leaves.name}",
                got="--motions gt",
                expected="--motions auto",
            )
        if num_motions == "gt":
            num_motions = self.leaves.num_motions
            if num_motions is None:
                raise InputError(
                    "the number of motions is not known",
                    where=f"sequence {self.leaves.name}",
                    got="--motions gt without ground truth",
                    expected="--motions auto or a number",
                )
        inputs = {"affinities": tuple(self.motions.affinity(view) for view in views)}
        if num_motions == "auto" and params.auto in READ_TRACKS:
            inputs["tracks"] = tuple(self.motions.tracks(index) for index in range(len(self.sections)))
            inputs["linking"] = self.objects.linking()
        place = {"num_views": len(views), "num_motions": None if num_motions == "auto" else num_motions}
        supports = self.rigid_supports(variant)
        if supports:
            inputs["rigid_support"] = supports
            place["has_rigid"] = True
        return self._nodes.add("clustering", inputs, **place)

    def rigid_supports(self, variant: Variant) -> tuple[str, ...]:
        """Return the references of the objects' rigid support that a variant's motion groups read.

        Only the fused variant reads it, because the others show what one view alone can do; and not where the
        configuration says that the background's group is static.
        """
        if variant != Variant.FUSED or self._config.clustering.static == "group":
            return ()
        return self.motions.rigid_supports()

    def cues(self) -> tuple[str, ...]:
        """Return the references of the tracks and of the forward flow, from which every motion model starts."""
        flows = map(self.frame_cues.flow_to_next, self.frame_cues.pictures.followed)
        return (*(self.motions.tracks(index) for index in range(len(self.sections))), *flows)
