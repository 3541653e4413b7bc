"""Leaves of the graph of a sequence: its decoded content, given cues and weights."""

from collections.abc import Mapping, Sequence
from itertools import chain, pairwise
from typing import NamedTuple

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.corrections import Edit
from moseg.schemas.recipes import Ref
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.schemas.stretch_choice import StretchChoice

GIVEN_SOURCES = ("groundtruth", "folder")
"""Methods of stages whose result the data set or the user gives."""


class SequenceLeaves(NamedTuple):
    """A sequence after ingest: references of its decoded content, and the properties that the graph reads.

    Attributes
    ----------
    name : str
    shape : (int, int)
        Height and width of the analysed frames, px.
    frames : tuple of references
        Those that are shown; `Nodes.frames` are those that are analysed.
    annotation : reference or None
        Ground truth at every pixel of the annotated frames.
    labelled_points : reference or None
        Ground truth at points, if there is no annotation.
    nothing_moves : bool
        Whether it is known that nothing moves: without annotation and points, every label is then wrong.
    void : int or None
        Annotated label of the pixels that are not scored.
    num_motions : int or None
        True number of motions, the background's included.
    masks, tracks : reference or None
        Given proposals and point tracks of the whole sequence.
    masks_void : int or None
        Label of the given proposals that is no object.
    depth, flow_forward, flow_backward : tuple of references or None
        Given cues, one per frame or frame pair.
    motion_weights : reference or None
        The motion network, if the configuration uses it.
    weights : mapping of str to reference
        The weights of the configuration's networks, by the name of their item; a leaf may be found when it is read.
    bars : BlackBars or None
        Black bars that are left out of the analysis, px of the analysed frames; None without any.
    graphics : ScreenGraphics or None
        Graphics that are left out of the analysis; None without any.
    repetitions : tuple of int
        Frames that repeat the one before them, beside those that were decoded to the same.
    gaps : tuple of int
        For each frame, how many pictures farther the one is that it is compared with; none where that is the next one
        everywhere.
    choices : tuple of StretchChoice
        The source of the proposals of every stretch, where the configuration leaves it to the camera's motion.
    cuts : tuple of int
        Frames that begin another scene; each scene is segmented like a video of its own.
    edits : tuple of Edit
        What the user corrects, in the order in which it applies.
    frame_size : (int, int) or None
        Height and width of the video's own frames, px, in which edits are written; None before there are any.
    """

    name: str
    shape: tuple[int, int]
    frames: tuple[Ref, ...]
    annotation: Ref | None = None
    labelled_points: Ref | None = None
    nothing_moves: bool = False
    void: int | None = None
    num_motions: int | None = None
    masks: Ref | None = None
    masks_void: int | None = None
    tracks: Ref | None = None
    depth: tuple[Ref, ...] | None = None
    flow_forward: tuple[Ref, ...] | None = None
    flow_backward: tuple[Ref, ...] | None = None
    motion_weights: Ref | None = None
    weights: Mapping[str, Ref] = {}
    bars: BlackBars | None = None
    graphics: ScreenGraphics | None = None
    repetitions: tuple[int, ...] = ()
    gaps: tuple[int, ...] = ()
    choices: tuple[StretchChoice, ...] = ()
    cuts: tuple[int, ...] = ()
    edits: tuple[Edit, ...] = ()
    frame_size: tuple[int, int] | None = None

    def refs(self) -> tuple[Ref, ...]:
        """Return the references of all content and cues."""
        single = (self.annotation, self.labelled_points, self.masks, self.tracks, self.motion_weights)
        several = (self.frames, self.depth, self.flow_forward, self.flow_backward)
        return (*filter(None, single), *chain.from_iterable(filter(None, several)))

    def picture(self) -> dict[str, BlackBars]:
        """Return the place of what is computed in the picture alone: the bars around it, if there are any."""
        return {} if self.bars is None else {"bars": self.bars}

    def hidden(self) -> dict[str, BlackBars | ScreenGraphics]:
        """Return the place of what is computed from the scene alone: the bars and graphics that hide some of it."""
        return self.picture() | ({} if self.graphics is None else {"graphics": self.graphics})

    def scenes(self) -> tuple["SequenceLeaves", ...]:
        """Return the leaves of each scene as those of a video of its own, without edits; these leaves without cuts."""
        if not self.cuts:
            return (self,)
        return tuple(self._scene(*bounds) for bounds in pairwise((0, *self.cuts, len(self.frames))))

    def joined(self, scenes: Sequence["SequenceLeaves"]) -> "SequenceLeaves":
        """Return these leaves with the repetitions, gaps and choices that were settled for their scenes."""
        placed = list(zip((0, *self.cuts), scenes, strict=True))
        gaps = tuple(gap for scene in scenes for gap in scene.gaps or (1,) * len(scene.frames))
        return self._replace(
            repetitions=tuple(start + frame for start, scene in placed for frame in scene.repetitions),
            gaps=gaps if max(gaps) > 1 else (),
            choices=tuple(choice.moved(start) for start, scene in placed for choice in scene.choices),
        )

    def _scene(self, start: int, stop: int) -> "SequenceLeaves":
        def pairs(flows: tuple[Ref, ...] | None) -> tuple[Ref, ...] | None:
            return None if flows is None else flows[start : stop - 1]

        return self._replace(
            frames=self.frames[start:stop],
            depth=None if self.depth is None else self.depth[start:stop],
            flow_forward=pairs(self.flow_forward),
            flow_backward=pairs(self.flow_backward),
            repetitions=tuple(frame - start for frame in self.repetitions if start <= frame < stop),
            gaps=self._gaps(start, stop),
            choices=tuple(each.moved(-start) for each in self.choices if start <= each.first_frame < stop),
            cuts=(),
            edits=(),
            frame_size=None,
        )

    def _gaps(self, start: int, stop: int) -> tuple[int, ...]:
        """Return the gaps of frames start..stop: none where they are 1, as in a video that has no slow motion."""
        gaps = self.gaps[start:stop]
        return gaps if max(gaps, default=1) > 1 else ()
