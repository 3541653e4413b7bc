"""Cues of frames and frame pairs: flow, inverse depth, motion saliency."""

from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES


class FrameCues:
    """Writer of the recipes of the cues of frames and frame pairs."""

    def __init__(self, nodes: Nodes):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves

    @cached_method
    def flow(self, frame0: int, frame1: int) -> str:
        """Return the reference of the flow from one frame to a neighbour."""
        params = self._config.flow
        if params.method in GIVEN_SOURCES:
            direction = "flow_forward" if frame1 > frame0 else "flow_backward"
            return self._nodes.required(direction, f"flow: {params.method}")[min(frame0, frame1)]
        return self._nodes.add("flow", {"frame0": self._leaves.frames[frame0], "frame1": self._leaves.frames[frame1]})

    @cached_method
    def depth(self, frame: int) -> str:
        """Return the reference of a frame's inverse depth."""
        method = self._config.depth.method
        if method in GIVEN_SOURCES:
            return self._nodes.required("depth", f"depth: {method}")[frame]
        return self._nodes.add("depth", {"frame": self._leaves.frames[frame]})

    def background(self, frame: int) -> str | None:
        """Return the reference of the background's model in a frame; None for layers, or if there is no frame pair.

        A run of frames shares it, and it reads pairs at fixed places: more frames of a video change few keys.
        """
        params, num_frames = self._config.saliency, len(self._leaves.frames)
        if params.background == "layers" or num_frames < 2:
            return None
        length = params.selection_length
        start = frame - frame % length
        # The last run joins the one before it if it is too short to choose a model.
        if start and num_frames - start < length / 2:
            start -= length
        return self._select_background(start)

    @cached_method
    def _select_background(self, start: int) -> str:
        params = self._config.saliency
        stop = min(start + params.selection_length, len(self._leaves.frames) - 1)
        flows = tuple(self.flow(frame0, frame0 + 1) for frame0 in range(start, stop, params.selection_step))
        return self._nodes.add("background", {"flows": flows})

    @cached_method
    def saliency(self, frame: int) -> str:
        """Return the reference of a frame's motion saliency."""
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

    def looked_at(self, start: int, stop: int) -> list[int]:
        """Return the frames whose logits the motion network gives to frames in a row: of these and right beside them.

        They are counted from `start`.
        """
        num_frames, step = len(self._leaves.frames), self._config.motion_network.step

        def is_looked_at(frame: int) -> bool:
            # the last frame too, unless it is beside one of the others
            return frame % step == 0 or (frame == num_frames - 1 and frame % step > 1)

        read = list(filter(is_looked_at, range(start, stop)))
        if start > 0 and not is_looked_at(start) and is_looked_at(start - 1):
            read.insert(0, start - 1)
        if stop < num_frames and not is_looked_at(stop - 1) and is_looked_at(stop):
            read.append(stop)
        return [frame - start for frame in read]

    @cached_method
    def motion_network(self, frame: int) -> str:
        """Return the reference of the motion network's logit for a frame."""
        frames = self._leaves.frames
        inputs = {
            "frame": frames[frame],
            "saliency": self.saliency(frame),
            "network": self._nodes.required("motion_weights", "motion network"),
        }
        for side, other in (("previous", frame - 1), ("next", frame + 1)):
            if 0 <= other < len(frames):
                inputs |= {side: frames[other], f"saliency_{side}": self.saliency(other)}
        return self._nodes.add("motion_network", inputs)
