"""Cues of frames and frame pairs: flow, inverse depth, motion saliency."""

from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.once import once
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES


class FrameCues:
    """Writes the recipes of what is seen in a frame or between two."""

    def __init__(self, nodes: Nodes):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves

    @once
    def flow(self, frame0: int, frame1: int) -> str:
        """Reference of the flow from one frame to a neighbour."""
        params = self._config.flow
        if params.method in GIVEN_SOURCES:
            direction = "flow_forward" if frame1 > frame0 else "flow_backward"
            return self._nodes.required(direction, f"flow: {params.method}")[min(frame0, frame1)]
        return self._nodes.add("flow", {"frame0": self._leaves.frames[frame0], "frame1": self._leaves.frames[frame1]})

    @once
    def depth(self, frame: int) -> str:
        """Reference of a frame's inverse depth."""
        method = self._config.depth.method
        if method in GIVEN_SOURCES:
            return self._nodes.required("depth", f"depth: {method}")[frame]
        return self._nodes.add("depth", {"frame": self._leaves.frames[frame]})

    def background(self, frame: int) -> str | None:
        """Reference of the background's model in a frame; None where layers are asked for, or there is no frame pair.

        Frames in a row share it, and it reads pairs at fixed places: more frames of a video move few keys.
        """
        params, num_frames = self._config.saliency, len(self._leaves.frames)
        if params.background == "layers" or num_frames < 2:
            return None
        length = params.selection_length
        start = frame - frame % length
        # A short rest of the video says little by itself.
        if start and num_frames - start < length / 2:
            start -= length
        return self._select_background(start)

    @once
    def _select_background(self, start: int) -> str:
        params = self._config.saliency
        stop = min(start + params.selection_length, len(self._leaves.frames) - 1)
        flows = tuple(self.flow(frame0, frame0 + 1) for frame0 in range(start, stop, params.selection_step))
        return self._nodes.add("background", {"flows": flows})

    @once
    def saliency(self, frame: int) -> str:
        """Reference of a frame's motion saliency."""
        frames = self._leaves.frames
        inputs = {"frame": frames[frame]}
        background = self.background(frame)
        if background is not None:
            inputs["background"] = background
        if frame > 0:
            inputs |= {"previous": frames[frame - 1], "flow_previous": self.flow(frame, frame - 1)}
        if frame + 1 < len(frames):
            inputs |= {"next": frames[frame + 1], "flow_next": self.flow(frame, frame + 1)}
        return self._nodes.add("saliency", inputs)
