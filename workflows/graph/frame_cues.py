"""Cues of frames and frame pairs: flow, inverse depth, motion saliency.

Evidence of motion is read from the neighbouring pictures, which are not always the neighbouring frames: a frame that is
repeated shows no motion to its repetition, and slow motion shows only some pictures farther. What is carried along the
flow goes from frame to frame.
"""

from collections.abc import Iterator

from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.pictures import Pictures
from moseg.workflows.graph.sequence_leaves import GIVEN_SOURCES


class FrameCues:
    """Writer of the recipes of the cues of frames and frame pairs.

    Attributes
    ----------
    pictures : Pictures
    """

    def __init__(self, nodes: Nodes):
        self._nodes = nodes
        self._config = nodes.config
        self.pictures = Pictures(nodes.frames, nodes.leaves.repetitions, nodes.leaves.gaps)

    @cached_method
    def flow(self, frame0: int, frame1: int) -> str:
        """Return the reference of the flow from one frame to a neighbour, or to the one that it is compared with."""
        params = self._config.flow
        if params.method in GIVEN_SOURCES:
            # Given for neighbours: from the last of the frames that repeat `frame0` on the way to `frame1`.
            direction, pair = ("flow_forward", frame1 - 1) if frame1 > frame0 else ("flow_backward", frame1)
            return self._nodes.required(direction, f"flow: {params.method}")[pair]
        return self._nodes.add("flow", {"frame0": self._nodes.frames[frame0], "frame1": self._nodes.frames[frame1]})

    def flow_to_next(self, frame: int) -> str:
        """Return the reference of the flow from one frame to the next picture it is compared with; must be there."""
        return self.flow(frame, self.pictures.next(frame))

    @cached_method
    def depth(self, frame: int) -> str:
        """Return the reference of a frame's inverse depth."""
        method = self._config.depth.method
        if method in GIVEN_SOURCES:
            return self._nodes.required("depth", f"depth: {method}")[frame]
        return self._nodes.add("depth", {"frame": self._nodes.frames[frame]})

    def background(self, frame: int) -> str | None:
        """Return the reference of the background's model in a frame; None for layers, or if there is no frame pair.

        A run of pictures shares it, and it reads pairs at fixed places: more frames of a video change few keys.
        """
        params, followed = self._config.saliency, self.pictures.num_followed
        if params.background == "layers" or len(self.pictures) < 2:
            return None
        # Of the pictures that are compared with a later one, and one more.
        num_pictures = self.pictures.of(followed - 1) + 2
        length, picture = params.selection_length, min(self.pictures.of(frame), num_pictures - 1)
        start = picture - picture % length
        # The last run joins the one before it if it is too short to choose a model.
        if start and num_pictures - start < length / 2:
            start -= length
        return self._select_background(start)

    @cached_method
    def _select_background(self, start: int) -> str:
        params = self._config.saliency
        followed = self.pictures.num_followed
        stop = min(start + params.selection_length, self.pictures.of(followed - 1) + 1)
        lasts = (self.pictures.frames(picture)[-1] for picture in range(start, stop, params.selection_step))
        flows = tuple(self.flow_to_next(min(frame, followed - 1)) for frame in lasts)
        return self._nodes.add("background", {"flows": flows})

    @cached_method
    def saliency(self, frame: int) -> str:
        """Return the reference of a frame's motion saliency."""
        frames = self._nodes.frames
        inputs = {"frame": frames[frame]}
        background = self.background(frame)
        if background is not None:
            inputs["background"] = background
        for side, other in self._beside(frame):
            inputs |= {side: frames[other], f"flow_{side}": self.flow(frame, other)}
        return self._nodes.add("saliency", inputs)

    @cached_method
    def steps(self, frame: int) -> str:
        """Return the reference of a frame's motion saliency with the flow to the frames right beside it.

        Maps are carried along it. That to a repetition is zero, and that to a picture farther away is shared out.
        """
        saliency, shares, beside = self.saliency(frame), self.pictures.shares(frame), dict(self._beside(frame))
        if set(shares.values()) == {1.0}:
            return saliency
        return self._nodes.add(
            "saliency", {"saliency": saliency}, "steps", **shares, given=[side in beside for side in shares]
        )

    def _beside(self, frame: int) -> Iterator[tuple[str, int]]:
        """Yield the sides of a frame on which there is a picture to compare it with, and the nearest frame of that."""
        for side, other in (("previous", self.pictures.previous(frame)), ("next", self.pictures.next(frame))):
            if other is not None:
                yield side, other

    def looked_at(self, start: int, stop: int) -> list[int]:
        """Return the frames whose logits the motion network gives to frames in a row: of these and right beside them.

        They are counted from `start`.
        """
        num_frames, step = len(self._nodes.frames), self._config.motion_network.step

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
        frames = self._nodes.frames
        inputs = {
            "frame": frames[frame],
            "saliency": self.saliency(frame),
            "network": self._nodes.required("motion_weights", "motion network"),
        }
        for side, other in self._beside(frame):
            back = self.pictures.next(other) if side == "previous" else self.pictures.previous(other)
            # At the border of slow motion the other frame may be compared with another picture.
            if back is not None and self.pictures.of(back) == self.pictures.of(frame):
                inputs |= {side: frames[other], f"saliency_{side}": self.saliency(other)}
        return self._nodes.add("motion_network", inputs)
