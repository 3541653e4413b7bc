"""Cues of frames and frame pairs: flow, inverse depth, motion saliency."""

from workflows.graph.nodes import Nodes
from workflows.graph.sequence_leaves import GIVEN_SOURCES


class FrameCues:
    """Writes the recipes of what is seen in a frame or between two."""

    def __init__(self, nodes: Nodes):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves

    def flow(self, frame0: int, frame1: int) -> str:
        """Reference of the flow from one frame to a neighbour."""
        params = self._config.flow
        if params.method in GIVEN_SOURCES:
            direction = "flow_forward" if frame1 > frame0 else "flow_backward"
            return self._nodes.required(direction, f"flow: {params.method}")[min(frame0, frame1)]
        inputs = {"frame0": self._leaves.frames[frame0], "frame1": self._leaves.frames[frame1]}
        if params.method == "dis":
            return self._nodes.add("flow", "dis", params.model_dump(mode="json", exclude={"method"}), inputs)
        read, weights = self._nodes.network(params.method)
        return self._nodes.add("flow", params.method, read, {**inputs, "weights": weights})

    def depth(self, frame: int) -> str:
        """Reference of a frame's inverse depth."""
        method = self._config.depth.method
        if method in GIVEN_SOURCES:
            return self._nodes.required("depth", f"depth: {method}")[frame]
        params, weights = self._nodes.network(method)
        return self._nodes.add("depth", method, params, {"frame": self._leaves.frames[frame], "weights": weights})

    def saliency(self, frame: int) -> str:
        """Reference of a frame's motion saliency."""
        frames = self._leaves.frames
        inputs = {"frame": frames[frame]}
        if frame > 0:
            inputs |= {"previous": frames[frame - 1], "flow_previous": self.flow(frame, frame - 1)}
        if frame + 1 < len(frames):
            inputs |= {"next": frames[frame + 1], "flow_next": self.flow(frame, frame + 1)}
        return self._nodes.add("saliency", "background-residual", self._config.saliency.model_dump(mode="json"), inputs)
