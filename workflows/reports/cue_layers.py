"""Layers of the cues: the frame, motion saliency, flow in the colours of a wheel, inverse depth."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from moseg.schemas.configs import MOVING_SOURCES, Variant
from moseg.tasks.flow.flow_grid import full_flow
from moseg.workflows.exports.colour_maps import (
    DEPTH_COLOURS,
    SOFT_COLOURS,
    colour_inverse_depth,
    colour_soft_map,
    draw_colour_bar,
)
from moseg.workflows.exports.draw_flow import colour_flow, draw_flow_wheel
from moseg.workflows.graph import GIVEN_SOURCES
from moseg.workflows.reports.content import Layer, LayerKind, Picture
from moseg.workflows.reports.layers import PlannedLayer, SequenceView, encode_opaque, encode_transparent
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
    leaves, cues = view.graph.leaves, view.graph.frame_cues

    def frame_refs(frames: Sequence[int]) -> tuple[str, ...]:
        return tuple(leaves.frames[frame] for frame in frames)

    def flow_refs(frames: Sequence[int]) -> tuple[str, ...]:
        return tuple(cues.flow(frame, frame + 1) for frame in _with_next(view, frames))

    def saliency_refs(frames: Sequence[int]) -> tuple[str, ...]:
        return tuple(map(cues.saliency, frames))

    def residual_flow_refs(frames: Sequence[int]) -> tuple[str, ...]:
        return (*saliency_refs(_with_next(view, frames)), *(flow_refs(frames) if _has_gaps(view) else ()))

    planned = [PlannedCue("frame", frame_refs, lambda: _prepare_frames(view))]
    models = {model for variant in variants for model in view.config.views(variant)}
    has_saliency = view.graph.objects.uses_saliency
    if has_saliency:
        planned.append(PlannedCue("motion saliency", saliency_refs, lambda: _prepare_saliency(view)))
    if view.config.proposal_source in MOVING_SOURCES or models - {"trajs"}:
        planned.append(PlannedCue("optical flow", flow_refs, lambda: _prepare_flow(view)))
    if has_saliency:
        name = "flow relative to the background"
        planned.append(PlannedCue(name, residual_flow_refs, lambda: _prepare_residual_flow(view)))
    method = view.config.depth.method
    if method in GIVEN_SOURCES or (method != "none" and models - {"trajs", "oc"}):
        planned.append(
            PlannedCue("inverse depth", lambda frames: tuple(map(cues.depth, frames)), lambda: _prepare_depth(view))
        )
    return planned


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


def _with_next(view: SequenceView, frames: Sequence[int]) -> tuple[int, ...]:
    """Return the frames that have a next frame."""
    return tuple(frame for frame in frames if frame + 1 < len(view.graph.leaves.frames))


def _has_gaps(view: SequenceView) -> bool:
    """Return whether the flow may be unknown in places, as flow from files may."""
    return view.config.flow.method in GIVEN_SOURCES


def _prepare_frames(view: SequenceView) -> CueDrawing:
    def draw(frame: int) -> Picture:
        return encode_opaque(shrink_to(view.store.read(view.graph.leaves.frames[frame], "image"), view.shape))

    return CueDrawing(draw, "The frame as analysed.")


def _prepare_saliency(view: SequenceView) -> CueDrawing:
    def draw(frame: int) -> Picture:
        saliency = view.store.read(view.graph.frame_cues.saliency(frame), "saliency").astype(np.float32)
        return encode_opaque(colour_soft_map(_resize(saliency, view.shape)))

    description = "Confidence that a pixel moves differently from the background, 0 to 1."
    return CueDrawing(draw, description, _draw_bar(SOFT_COLOURS, "0", "1"))


def _prepare_flow(view: SequenceView) -> CueDrawing:
    return _prepare_flows(view, "Motion of every pixel to the next frame", lambda frame: _read_flow(view, frame))


def _prepare_residual_flow(view: SequenceView) -> CueDrawing:
    width = view.graph.leaves.shape[1]

    def read(frame: int) -> np.ndarray:
        # The second direction is the one to the next frame.
        flow = view.store.read(view.graph.frame_cues.saliency(frame), "residual_flows")[1].astype(np.float32)
        flow *= np.float32(width / flow.shape[1])
        if _has_gaps(view):
            # Saliency fills gaps with known values beside them, or with zeros.
            unknown = ~np.isfinite(_read_flow(view, frame)).all(axis=-1)
            flow[_resize(unknown.astype(np.float32), flow.shape[:2]) > 0.5] = np.nan
        return flow

    return _prepare_flows(view, "Flow to the next frame minus the flow of the background", read)


def _read_flow(view: SequenceView, frame: int) -> np.ndarray:
    ref = view.graph.frame_cues.flow(frame, frame + 1)
    return full_flow(view.store.read(ref, "flow"), view.store.attributes(ref))


def _prepare_flows(view: SequenceView, what: str, read: Callable[[int], np.ndarray]) -> CueDrawing:
    # Read twice, for the scale and for the colours: only one flow is in memory.
    lengths = [_long_vector(read(frame)) for frame in _with_next(view, view.frames)]
    longest = float(np.percentile(lengths, SCALE_PERCENTILE)) if lengths else 0.0

    def draw(frame: int) -> Picture | None:
        if frame + 1 == len(view.graph.leaves.frames):
            return None
        return encode_opaque(colour_flow(_resize(read(frame), view.shape), longest))

    scale = f"full colour at {longest:.3g} px/frame, darker beyond"
    description = f"{what}, as a vector from the wheel's centre: white where it is 0, {scale}, black where unknown."
    return CueDrawing(draw, description, encode_transparent(draw_flow_wheel(WHEEL_SIDE)))


def _prepare_depth(view: SequenceView) -> CueDrawing:
    def read(frame: int) -> np.ndarray:
        return view.store.read(view.graph.frame_cues.depth(frame), "inverse_depth")

    percentiles = [np.percentile(read(frame), (100 - LARGEST_PERCENTILE, LARGEST_PERCENTILE)) for frame in view.frames]
    farthest, nearest = min(low for low, _ in percentiles), max(high for _, high in percentiles)

    def draw(frame: int) -> Picture:
        return encode_opaque(colour_inverse_depth(_resize(read(frame), view.shape), farthest, nearest))

    description = "Inverse depth, relative, on one scale for all frames of the sequence: the lighter, the nearer."
    return CueDrawing(draw, description, _draw_bar(DEPTH_COLOURS, "far", "near"))


def _long_vector(flow: np.ndarray) -> float:
    """Return the length that few of a flow's known vectors exceed, in its unit."""
    length = np.hypot(flow[..., 0], flow[..., 1])
    length = length[np.isfinite(length)]
    return float(np.percentile(length, LARGEST_PERCENTILE)) if length.size else 0.0


def _resize(values: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Resize values (y, x, ...); where some are not finite, by nearest neighbours."""
    size = shape[1], shape[0]
    if not np.isfinite(values).all():
        return cv2.resize(values, size, interpolation=cv2.INTER_NEAREST_EXACT)
    return cv2.resize(values, size, interpolation=cv2.INTER_AREA if size[1] < len(values) else cv2.INTER_LINEAR)


def _draw_bar(colours: int, min_text: str, max_text: str) -> Picture:
    """Draw a colour bar with the meaning of its ends written on them, legible on light and dark pages."""
    bar = Image.fromarray(draw_colour_bar(BAR_SHAPE, colours))
    pen, font = ImageDraw.Draw(bar), ImageFont.load_default(14)
    height, width = BAR_SHAPE
    pen.text((6, height // 2), min_text, (255, 255, 255), font, anchor="lm")
    pen.text((width - 6, height // 2), max_text, (0, 0, 0), font, anchor="rm")
    return encode_transparent(np.dstack([np.asarray(bar), np.full(BAR_SHAPE, 255, np.uint8)]))
