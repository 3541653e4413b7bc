"""Motions: point tracks, motion models of every object, and the affinity between objects under each model."""

from workflows.graph.frame_cues import FrameCues
from workflows.graph.nodes import Nodes
from workflows.graph.objects import Objects
from workflows.graph.sequence_leaves import GIVEN_SOURCES
from workflows.sections import Section

LUCAS_KANADE_PARAMS = {"window", "pyramid_levels", "forward_backward"}


class Motions:
    """Writes the recipes from cues and objects to affinities."""

    def __init__(self, nodes: Nodes, cues: FrameCues, objects: Objects, sections: tuple[Section, ...]):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves
        self._cues = cues
        self._objects = objects
        self._sections = sections
        self._tracks: dict[int, str] = {}

    def affinity(self, view: str) -> str:
        """Reference of the objects' affinity under one motion model."""
        params = self._config.affinity
        is_flow = view != "trajs"
        # Support for static has a scale whichever affinity goes with it.
        unread = {"method"} | ({"direction"} if params.method == "ork" else {"ork_threshold", "ork_reading"})
        if not is_flow:
            unread.add("relative_flow")
        read = params.model_dump(mode="json", exclude=unread)
        residuals = self.residuals(view)
        return self._nodes.add(
            "affinity", params.method, {"is_flow": is_flow, "affinity": read}, {"residuals": residuals}
        )

    def residuals(self, view: str) -> tuple[str, ...]:
        """References of the residuals of every section's frame pairs under one motion model."""
        num_frames = len(self._leaves.frames)
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

    def tracks(self, index: int) -> str:
        """Reference of a section's point tracks; they reach `gap` frames into the next section."""
        if index not in self._tracks:
            self._tracks[index] = self._track(index)
        return self._tracks[index]

    def _track(self, index: int) -> str:
        section = self._sections[index]
        stop = min(section.stop + self._config.fundamental.gap, len(self._leaves.frames))
        params = self._config.tracks
        if params.method in GIVEN_SOURCES:
            given = self._nodes.required("tracks", f"tracks: {params.method}")
            inputs = {"tracks": given, "proposals": self._objects.proposals(index)}
            return self._nodes.add("tracks", "given", {"start": section.start, "stop": stop}, inputs)
        inputs = {
            "frames": self._leaves.frames[section.start : stop],
            "proposals": self._objects.proposals(index),
        }
        read = {"num_frames": min(self._objects.labelled_until(index), stop) - section.start}
        unread = {"method"}
        if params.method != "lucas-kanade":
            unread |= LUCAS_KANADE_PARAMS
            network, inputs["weights"] = self._nodes.network(params.method)
            read |= network
        read["tracks"] = params.model_dump(mode="json", exclude=unread)
        return self._nodes.add("tracks", params.method, read, inputs)

    def _fundamental_residual(self, index: int, num_pairs: int, gap: int) -> str:
        cues = {"tracks": self.tracks(index), "linking": self._objects.linking()}
        pairs = {"section": index, "num_pairs": num_pairs, "gap": gap}
        params = self._config.fundamental.model_dump(mode="json", exclude={"gap"})
        fitted = {name: value for name, value in params.items() if name != "statistic"}
        fit = {**pairs, "shape": list(self._leaves.shape), "fundamental": fitted}
        fits = self._nodes.add("fundamental", "ransac", fit, cues)
        read = {name: params[name] for name in ("statistic", "min_points")}
        return self._nodes.add(
            "fundamental_residual", "sampson", {**pairs, "fundamental": read}, {"fits": fits, **cues}
        )

    def _flow_residual(self, index: int, num_pairs: int, model: str) -> str:
        start = self._sections[index].start
        frames = range(start, start + num_pairs)
        inputs = {
            "flow": tuple(self._cues.flow(frame, frame + 1) for frame in frames),
            "proposals": self._objects.proposals(index),
            "linking": self._objects.linking(),
        }
        if model != "oc" and self._config.depth.method != "none":
            inputs["depth"] = tuple(self._cues.depth(frame) for frame in frames)
        params = {"section": index, "model": model, "flow_model": self._config.flow_model.model_dump(mode="json")}
        fits = self._nodes.add("flow_model", "least-squares", params, inputs)
        return self._nodes.add("flow_residual", "mean-squared-error", {}, {"fits": fits})
