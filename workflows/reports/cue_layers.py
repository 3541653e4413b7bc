"""Layers of the cues: the frame, motion saliency, flow in the colours of a wheel, inverse depth."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from moseg.schemas.configs import Variant
from moseg.workflows.exports.colour_maps import (
    DEPTH_COLOURS,
    SOFT_COLOURS,
    colour_inverse_depth,
    colour_soft_map,
    draw_colour_bar,
)
from moseg.workflows.exports.draw_flow import colour_flow, draw_flow_wheel
from moseg.workflows.reports.content import Layer, LayerKind, Picture
from moseg.workflows.reports.layers import PlannedLayer, SequenceView, encode_opaque, encode_transparent
from moseg.workflows.results.frame_cues import FrameCue, frame_cues, resize_cue
from moseg.workflows.sources.resize import shrink_to

WHEEL_SIDE = 96
BAR_SHAPE = (24, 220)
"""Height and width of a colour bar, px."""
LARGEST_PERCENTILE = 99
"""Of a frame: a value that few pixels exceed, free of outliers."""
SCALE_PERCENTILE = 75
"""Of the frames of a sequence: a single frame in which flow fails would make all others pale."""


class CueDrawing(NamedTuple):
    """A cue whose scale is settled.

    Attributes
    ----------
    draw : function of a frame's index
        Returns its picture; None for a frame that has none, such as the flow of the last one.
    description : str
    key : Picture or None
    """

    draw: Callable[[int], Picture | None]
    description: str
    key: Picture | None = None


class PlannedCue(NamedTuple):
    """A cue that can be drawn.

    Attributes
    ----------
    name : str
    refs : function of frames' indices
        Returns the references that their pictures read.
    prepare : function without arguments
        Settles the scale, by the frames of the view.
    """

    name: str
    refs: Callable[[Sequence[int]], tuple[str, ...]]
    prepare: Callable[[], CueDrawing]


def plan_cue_layers(view: SequenceView, variants: Sequence[Variant]) -> list[PlannedLayer]:
    """Plan the layers of the cues that a run of the variants reads."""
    return [_plan_layer(view, cue) for cue in plan_cues(view, variants)]


def plan_cues(view: SequenceView, variants: Sequence[Variant]) -> list[PlannedCue]:
    """Plan the drawing of the cues that a run of the variants reads, the frame first."""
    leaves = view.graph.leaves

    def frame_refs(frames: Sequence[int]) -> tuple[str, ...]:
        return tuple(leaves.frames[frame] for frame in frames)

    planned = [PlannedCue("frame", frame_refs, lambda: _prepare_frames(view))]
    for name, cue in frame_cues(view.graph, view.config, variants).items():
        shown, prepare = _DRAWN[name]
        planned.append(PlannedCue(shown, partial(_refs_of_frames, cue), partial(prepare, view, cue)))
    return planned


def _refs_of_frames(cue: FrameCue, frames: Sequence[int]) -> tuple[str, ...]:
    """Return what the pictures of frames read, without those of frames that do not have the cue."""
    return tuple(ref for frame in frames if frame in cue.frames for ref in cue.refs(frame))


def _plan_layer(view: SequenceView, cue: PlannedCue) -> PlannedLayer:
    """Plan a cue as a layer of the frames of a view."""

    def make() -> Layer:
        drawing = cue.prepare()
        pictures = tuple(map(drawing.draw, view.frames))
        is_shown = cue.name == "frame"
        return Layer(
            cue.name,
            LayerKind.BASE,
            pictures,
            key=drawing.key,
            description=drawing.description,
            is_shown=is_shown,
        )

    return PlannedLayer(cue.name, cue.refs(view.frames), make)


def _prepare_frames(view: SequenceView) -> CueDrawing:
    def draw(frame: int) -> Picture:
        return encode_opaque(shrink_to(view.store.read(view.graph.leaves.frames[frame], "image"), view.shape))

    filled = "The frame; for the analysis, the scene beside them stands for its black bars and graphics."
    return CueDrawing(draw, filled if view.graph.leaves.hidden() else "The frame as analysed.")


def _prepare_saliency(view: SequenceView, cue: FrameCue) -> CueDrawing:
    def draw(frame: int) -> Picture:
        return encode_opaque(colour_soft_map(resize_cue(cue.read(view.store, *cue.refs(frame)), view.shape)))

    description = "Confidence that a pixel moves differently from the background, 0 to 1."
    return CueDrawing(draw, description, _draw_bar(SOFT_COLOURS, "0", "1"))


def _prepare_flow(view: SequenceView, cue: FrameCue) -> CueDrawing:
    return _prepare_flows(view, cue, "Motion of every pixel to the next frame")


def _prepare_residual_flow(view: SequenceView, cue: FrameCue) -> CueDrawing:
    return _prepare_flows(view, cue, "Flow to the next frame minus the flow of the background")


def _prepare_flows(view: SequenceView, cue: FrameCue, what: str) -> CueDrawing:
    # Read twice, for the scale and for the colours: only one flow is in memory.
    lengths = [_long_vector(cue.read(view.store, *cue.refs(frame))) for frame in view.frames if frame in cue.frames]
    longest = float(np.percentile(lengths, SCALE_PERCENTILE)) if lengths else 0.0

    def draw(frame: int) -> Picture | None:
        if frame not in cue.frames:
            return None
        return encode_opaque(colour_flow(resize_cue(cue.read(view.store, *cue.refs(frame)), view.shape), longest))

    scale = f"full colour at {longest:.3g} px/frame, darker beyond"
    description = f"{what}, as a vector from the wheel's centre: white where it is 0, {scale}, black where unknown."
    return CueDrawing(draw, description, encode_transparent(draw_flow_wheel(WHEEL_SIDE)))


def _prepare_depth(view: SequenceView, cue: FrameCue) -> CueDrawing:
    def read(frame: int) -> np.ndarray:
        return cue.read(view.store, *cue.refs(frame))

    percentiles = [np.percentile(read(frame), (100 - LARGEST_PERCENTILE, LARGEST_PERCENTILE)) for frame in view.frames]
    farthest, nearest = min(low for low, _ in percentiles), max(high for _, high in percentiles)

    def draw(frame: int) -> Picture:
        return encode_opaque(colour_inverse_depth(resize_cue(read(frame), view.shape), farthest, nearest))

    description = "Inverse depth, relative, on one scale for all frames of the sequence: the lighter, the nearer."
    return CueDrawing(draw, description, _draw_bar(DEPTH_COLOURS, "far", "near"))


def _long_vector(flow: np.ndarray) -> float:
    """Return the length that few of a flow's known vectors exceed, in its unit."""
    length = np.hypot(flow[..., 0], flow[..., 1])
    length = length[np.isfinite(length)]
    return float(np.percentile(length, LARGEST_PERCENTILE)) if length.size else 0.0


def _draw_bar(colours: int, min_text: str, max_text: str) -> Picture:
    """Draw a colour bar with the meaning of its ends written on them, legible on light and dark pages."""
    bar = Image.fromarray(draw_colour_bar(BAR_SHAPE, colours))
    pen, font = ImageDraw.Draw(bar), ImageFont.load_default(14)
    height, width = BAR_SHAPE
    pen.text((6, height // 2), min_text, (255, 255, 255), font, anchor="lm")
    pen.text((width - 6, height // 2), max_text, (0, 0, 0), font, anchor="rm")
    return encode_transparent(np.dstack([np.asarray(bar), np.full(BAR_SHAPE, 255, np.uint8)]))


_DRAWN = {
    "saliency": ("motion saliency", _prepare_saliency),
    "flow": ("optical flow", _prepare_flow),
    "residual_flow": ("flow relative to the background", _prepare_residual_flow),
    "inverse_depth": ("inverse depth", _prepare_depth),
}
"""Title of each cue, and the function that settles its scale."""
