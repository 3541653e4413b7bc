"""Motions: point tracks, motion models of every object, and the affinity between objects under each model."""

from collections.abc import Iterator, Set

from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.objects import Objects
from moseg.workflows.graph.once import once
from moseg.workflows.graph.sections import Section
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES

LUCAS_KANADE_PARAMS = {"window", "pyramid_levels", "forward_backward"}
BY_HYPOTHESES = ("hypotheses", "combined")
"""Methods of the affinity that compare objects under many hypotheses of motion, alone or beside their own models."""
CELL_PARAMS = {"background_rows", "background_columns"}
PATCH_PARAMS = {"block", "min_patch", "elongation"}
PREFERENCE_PARAMS = {"window", "noise_floor", "scale_quantile"}


class Motions:
    """Writes the recipes from cues and objects to affinities."""

    def __init__(self, nodes: Nodes, cues: FrameCues, objects: Objects, sections: tuple[Section, ...]):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves
        self._cues = cues
        self._objects = objects
        self._sections = sections

    @once
    def affinity(self, view: str) -> str:
        """Reference of the objects' affinity under one motion model."""
        method = self._config.affinity.method
        params: dict = {"is_flow": view != "trajs"}
        inputs = {}
        if method != "hypotheses":
            params["affinity"] = self._affinity_params(view)
            inputs["residuals"] = self.residuals(view)
        if method in BY_HYPOTHESES:
            params["hypotheses"] = self._hypothesis_params(PREFERENCE_PARAMS | CELL_PARAMS)
            if view == "trajs":
                del params["hypotheses"]["noise_floor"]
            inputs["hypotheses"] = self.hypotheses(view)
        return self._nodes.add("affinity", method, params, inputs)

    @once
    def residuals(self, view: str) -> tuple[str, ...]:
        """References of the residuals of every section's frame pairs under the objects' models of one kind."""
        if view == "trajs":
            return tuple(self._fundamental_residual(*pairs) for pairs in self._pairs(self._config.fundamental.gap))
        return tuple(self._flow_residual(index, num_pairs, view) for index, num_pairs, _ in self._pairs(1))

    @once
    def hypotheses(self, view: str) -> tuple[str, ...]:
        """References of the residuals of every section's frame pairs under many hypotheses of one kind of model."""
        if view == "trajs":
            return tuple(self._track_hypotheses(*pairs) for pairs in self._pairs(self._config.fundamental.gap))
        return tuple(self._flow_hypotheses(index, num_pairs, view) for index, num_pairs, _ in self._pairs(1))

    @once
    def tracks(self, index: int) -> str:
        """Reference of a section's point tracks; they reach `gap` frames into the next section."""
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

    def _pairs(self, gap: int) -> Iterator[tuple[int, int, int]]:
        """Every section that has pairs of frames: its index, their number, and the frames between the two of a pair."""
        num_frames = len(self._leaves.frames)
        gap = min(gap, num_frames - 1)
        for index, section in enumerate(self._sections):
            num_pairs = min(section.stop, num_frames - gap) - section.start
            if num_pairs > 0:
                yield index, num_pairs, gap

    def _affinity_params(self, view: str) -> dict:
        """The parameters that an affinity from residuals under the objects' own models reads."""
        params = self._config.affinity
        # Support for static has a scale whichever affinity goes with it.
        unread = {"method"} | ({"direction"} if params.method == "ork" else {"ork_threshold", "ork_reading"})
        if view == "trajs":
            unread.add("relative_flow")
        return params.model_dump(mode="json", exclude=unread)

    def _hypothesis_params(self, names: Set[str]) -> dict:
        return self._config.object_hypotheses.model_dump(mode="json", include=set(names))

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

    def _track_hypotheses(self, index: int, num_pairs: int, gap: int) -> str:
        params = {"section": index, "num_pairs": num_pairs, "gap": gap, "shape": list(self._leaves.shape)}
        params["min_points"] = self._config.fundamental.min_points
        params["hypotheses"] = self._hypothesis_params({"num_hypotheses"} | CELL_PARAMS)
        inputs = {"tracks": self.tracks(index), "linking": self._objects.linking()}
        return self._nodes.add("object_hypotheses", "track-samples", params, inputs)

    def _flow_hypotheses(self, index: int, num_pairs: int, model: str) -> str:
        params = self._flow_params(index, model)
        params["hypotheses"] = self._hypothesis_params({"num_hypotheses"} | PATCH_PARAMS | CELL_PARAMS)
        return self._nodes.add("object_hypotheses", "flow-patches", params, self._flow_inputs(index, num_pairs, model))

    def _flow_residual(self, index: int, num_pairs: int, model: str) -> str:
        params, inputs = self._flow_params(index, model), self._flow_inputs(index, num_pairs, model)
        fits = self._nodes.add("flow_model", "least-squares", params, inputs)
        return self._nodes.add("flow_residual", "mean-squared-error", {}, {"fits": fits})

    def _flow_params(self, index: int, model: str) -> dict:
        return {"section": index, "model": model, "flow_model": self._config.flow_model.model_dump(mode="json")}

    def _flow_inputs(self, index: int, num_pairs: int, model: str) -> dict:
        start = self._sections[index].start
        frames = range(start, start + num_pairs)
        inputs = {
            "flow": tuple(self._cues.flow(frame, frame + 1) for frame in frames),
            "proposals": self._objects.proposals(index),
            "linking": self._objects.linking(),
        }
        if model != "oc" and self._config.depth.method != "none":
            inputs["depth"] = tuple(self._cues.depth(frame) for frame in frames)
        return inputs
