"""Painted sections: from strokes and points of single frames to the pixels of every section that they reach."""

from collections.abc import Sequence

from moseg.schemas.corrections import Add, Edit, Growing, Paint
from moseg.workflows.graph.cached_method import cached_method
from moseg.workflows.graph.frame_cues import FrameCues
from moseg.workflows.graph.joined_writers import JoinedCues
from moseg.workflows.graph.nodes import Nodes
from moseg.workflows.graph.sections import Section, place_frame
from moseg.workflows.stages.accumulation import PASSES


class PaintedSections:
    """Writer of the recipes of what a user paints, erases and adds.

    An edit has nodes of its own, one for each section that it reaches, so that another edit leaves them as they are.

    Parameters
    ----------
    scenes : sequence of range
        The sections of each scene, beyond which no edit reaches.
    """

    def __init__(
        self, nodes: Nodes, cues: FrameCues | JoinedCues, sections: tuple[Section, ...], scenes: Sequence[range]
    ):
        self._nodes = nodes
        self._config = nodes.config
        self._leaves = nodes.leaves
        self._cues = cues
        self._sections = sections
        self._scenes = scenes

    def painted(self, index: int) -> str | None:
        """Return the reference of a section's painted pixels; None where no edit reaches it."""
        section, masks, first, brushes, drawn = self._sections[index], [], [], [], []
        for edit, brush in self._brushes().items():
            if index in self._masks(edit):
                masks.append(self._masks(edit)[index])
                first.append(max(self._reach(edit)[0] - section.start, 0))
                brushes.append(brush)
                drawn.append(self._drawn_row(edit, index, section.start + first[-1]))
        if not masks:
            return None
        place = {"num_frames": section.stop - section.start, "first": first, "brushes": brushes}
        if self._leaves.bars is not None:
            place |= {"bars": self._leaves.bars, "drawn": drawn}
        return self._nodes.add("painted", {"masks": tuple(masks)}, **place)

    def _drawn_row(self, edit: int, index: int, first: int) -> int | None:
        """Return the row of an edit's mask in a section, counted from frame `first`, whose strokes the user drew."""
        value = _value(self._leaves.edits[edit])
        is_drawn = index == self._own(edit) and not isinstance(value, Growing)
        return value.frame - first if is_drawn else None

    @cached_method
    def _brushes(self) -> dict:
        # Here, because programs start without the tasks.
        from moseg.tasks.corrections.painting import brushes_of

        return brushes_of(self._leaves.edits)

    def _reach(self, edit: int) -> tuple[int, int]:
        """Return the frames start..stop that an edit reaches: those near it, and in any case those of its section.

        What SAM 2.1 tracks reaches the whole scene.
        """
        scene, value = self._scene(edit), _value(self._leaves.edits[edit])
        first, last = self._sections[scene[0]].start, self._sections[scene[-1]].stop
        if _is_tracked(value):
            return first, last
        section, reach = self._sections[self._own(edit)], self._config.carrying.reach
        return max(min(section.start, value.frame - reach), first), min(
            max(section.stop, value.frame + reach + 1), last
        )

    def _own(self, edit: int) -> int:
        """Return the section of an edit's own frame."""
        return place_frame(self._sections, _value(self._leaves.edits[edit]).frame)[0]

    def _scene(self, edit: int) -> range:
        """Return the sections of the scene of an edit's own frame."""
        own = self._own(edit)
        return next(scene for scene in self._scenes if own in scene)

    @cached_method
    def _masks(self, edit: int) -> dict[int, str]:
        """Return the references of an edit's pixels in the sections that it reaches, by section."""
        (start, stop), own, scene = self._reach(edit), self._own(edit), self._scene(edit)
        masks = {own: self._start(edit, own)}
        for index in range(own + 1, scene.stop):
            if self._sections[index].start < stop:
                masks[index] = self._continue(edit, index, masks[index - 1])
        for index in range(own - 1, scene.start - 1, -1):
            if self._sections[index].stop > start:
                masks[index] = self._continue(edit, index, masks[index + 1])
        return masks

    def _continue(self, edit: int, index: int, before: str) -> str:
        """Return the reference of an edit's pixels in a section, from those in the section that they come from."""
        section, origin = self._sections[index], PASSES[index < self._own(edit)]
        if not _is_tracked(_value(self._leaves.edits[edit])):
            inputs = {"carried": before, **self._cues_of(edit, index)}
            return self._nodes.add("carried_mask", inputs, "continued", origin=origin)
        border = section.start - 1 if origin == PASSES[0] else section.stop
        frames = self._nodes.frames[section.start : section.stop]
        inputs = {"tracked": before, "frames": frames, "border": self._nodes.frames[border]}
        return self._nodes.add("tracked_mask", inputs, "continued", origin=origin)

    def _start(self, edit: int, index: int) -> str:
        """Return the reference of an edit's pixels in the section of its own frame."""
        value, start = _value(self._leaves.edits[edit]), self._sections[index].start
        place = {"frame": value.frame - start}
        if not isinstance(value, Growing):
            size = {"strokes": value.strokes, "frame_size": self._leaves.frame_size}
            return self._nodes.add("carried_mask", self._cues_of(edit, index), "strokes", **place, **size)
        grown = {"grown_object": self._grow(edit)}
        if not _is_tracked(value):
            return self._nodes.add("carried_mask", grown | self._cues_of(edit, index), "grown", **place)
        grown["frames"] = self._nodes.frames[start : self._sections[index].stop]
        return self._nodes.add("tracked_mask", grown, "grown", **place)

    def _grow(self, edit: int) -> str:
        value = _value(self._leaves.edits[edit])
        inputs = {"frame": self._nodes.frames[value.frame]}
        if not _is_tracked(value):
            inputs["saliency"] = self._cues.saliency(value.frame)
        return self._nodes.add("grown_object", inputs, value.by, growing=value, frame_size=self._leaves.frame_size)

    def _cues_of(self, edit: int, index: int) -> dict:
        """Return the frames of a section that an edit reaches, and the flow of the pairs along which it comes."""
        (start, stop), section, own = self._reach(edit), self._sections[index], self._own(edit)
        start, stop = max(start, section.start), min(stop, section.stop)
        # Of the pair over the cut too where it comes from another section.
        pairs = range(start - (index > own), stop - 1 + (index < own))
        return {
            "frames": self._nodes.frames[start:stop],
            "flow_forward": tuple(self._cues.flow(frame, frame + 1) for frame in pairs),
            "flow_backward": tuple(self._cues.flow(frame + 1, frame) for frame in pairs),
        }


def _value(edit: Edit):
    """Return what an edit with pixels says."""
    if isinstance(edit, Paint):
        return edit.paint
    return edit.add if isinstance(edit, Add) else edit.erase


def _is_tracked(value) -> bool:
    return isinstance(value, Growing) and value.by == "sam2"
