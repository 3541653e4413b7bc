"""Motion saliency of one frame from the flow to its neighbours."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.frame_grid import flow_on_grid, frame_on_grid, grid_shape
from moseg.tasks.half_floats import to_float16
from moseg.tasks.saliency.background import AffineMotion
from moseg.tasks.saliency.camera import fit_camera_motion
from moseg.tasks.saliency.choice import LAYERS, BackgroundChoice
from moseg.tasks.saliency.grid import vector_length
from moseg.tasks.saliency.layers import Background, fit_layers
from moseg.tasks.saliency.photometric import blur_error, colour_error, photometric_gate
from moseg.tasks.saliency.rest import is_at_rest, resting_background
from moseg.tasks.saliency.rigid import explain_rigidly
from moseg.tasks.saliency.soft_map import soft_map


class FrameSaliency(NamedTuple):
    """Motion saliency of a frame and its flows on the working grid (h, w).

    Attributes
    ----------
    saliency : float16 (h, w)
        0..1.
    strict_saliency : float16 (h, w)
        The same with the strict photometric gate: less of what moves, and hardly any water.
    flows : float16 (2, h, w, 2)
        To the previous and to the next frame, px/frame of the working grid; zeros where there is none.
    residual_flows : float16 (2, h, w, 2)
        `flows` less the background's.
    first_layers : two of AffineMotion or None
        Motion of the background's first layer in both directions; None where there is no flow, or for a rigid scene.
    """

    saliency: np.ndarray
    strict_saliency: np.ndarray
    flows: np.ndarray
    residual_flows: np.ndarray
    first_layers: tuple[AffineMotion | None, AffineMotion | None]


def estimate_saliency(
    frame: np.ndarray,
    previous: np.ndarray | None,
    next: np.ndarray | None,
    flow_previous: np.ndarray | None,
    flow_next: np.ndarray | None,
    params: SaliencyParams,
    choice: BackgroundChoice = LAYERS,
    size: tuple[int, int] | None = None,
) -> FrameSaliency:
    """Estimate how probable it is that each pixel of a frame moves on its own.

    The residual against the background's motion is the smaller of both time directions: an occlusion affects only one.

    Parameters
    ----------
    frame : uint8 (y, x, 3)
        RGB, or the same on the working grid, if `size` is given.
    previous, next : uint8 (y, x, 3) or None
        The frames before and after; None at the ends of the sequence.
    flow_previous, flow_next : float32 (y, x, 2) or None
        Flow from `frame` to `previous` and to `next`, px/frame, of the frames' size or on a coarser grid; None together
        with the frame.
    params : SaliencyParams
    choice : BackgroundChoice, optional
        The background's model; layers without it.
    size : (height, width), optional
        Of the frames themselves, where those given are on the working grid, px; by default that of `frame`.

    Returns
    -------
    FrameSaliency

    Raises
    ------
    InputError
        A neighbour's size is not the frame's, a flow's grid has not the proportions of the frame, or only one of a
        neighbour and its flow is given.
    """
    size = size or frame.shape[:2]
    shape = grid_shape(size, params.working_side)
    flows, residual_flows = np.zeros((2, 2, *shape, 2), np.float16)
    resampled = frame_on_grid(frame, shape)
    backgrounds: list[Background] = []
    first_layers: list[AffineMotion | None] = [None, None]
    errors = []
    for direction, (other, flow) in enumerate(((previous, flow_previous), (next, flow_next))):
        if not _is_given(frame, other, flow, size):
            continue
        observed = flow_on_grid(flow, shape, size)
        background = _explain(observed, resampled, params, choice)
        flows[direction], residual_flows[direction] = to_float16(observed), to_float16(observed - background.flow)
        first_layers[direction] = background.first_layer
        backgrounds.append(background)
        errors.append(colour_error(resampled, frame_on_grid(other, shape), background.flow))
    if not backgrounds:
        return FrameSaliency(*np.zeros((2, *shape), np.float16), flows, residual_flows, (None, None))
    residual = np.minimum.reduce([background.residual for background in backgrounds])
    speed = np.minimum.reduce([vector_length(background.flow) for background in backgrounds])
    at_rest = all(background.is_at_rest for background in backgrounds)
    ungated = soft_map(residual, speed, params, choice.model == "rigid" and not at_rest, at_rest)
    error = blur_error(np.minimum.reduce(errors), params.gate_blur)
    saliency, strict = (
        to_float16(ungated * photometric_gate(error, scale)) for scale in (params.gate_error, params.strict_gate_error)
    )
    return FrameSaliency(saliency, strict, flows, residual_flows, tuple(first_layers))


def _explain(flow: np.ndarray, image: np.ndarray, params: SaliencyParams, choice: BackgroundChoice) -> Background:
    """Return a background at rest, or fit the chosen model, or layers where a pair shows no camera motion."""
    if is_at_rest(flow, image, params):
        return resting_background(flow, params)
    motion = fit_camera_motion(flow, choice.focal, params) if choice.model == "rigid" else None
    return fit_layers(flow, params) if motion is None else explain_rigidly(flow, motion, params)


def _is_given(frame: np.ndarray, other: np.ndarray | None, flow: np.ndarray | None, size: tuple[int, int]) -> bool:
    """Check whether a neighbour and its flow are given, and that they fit the frame."""
    if other is None and flow is None:
        return False
    if other is None or flow is None:
        raise InputError(
            "a neighbouring frame and its flow belong together", got="one of them", expected="both or none"
        )
    if other.shape != frame.shape or not _is_grid_of(size, flow):
        raise InputError(
            "neighbour of another size", got=f"{other.shape}, flow {flow.shape}", expected=f"{frame.shape} and its flow"
        )
    return True


def _is_grid_of(size: tuple[int, int], flow: np.ndarray) -> bool:
    """Check whether a flow is on a grid with the proportions of frames of a size, up to the rounding of its sides."""
    height, width = size
    return flow.shape[2:] == (2,) and abs(flow.shape[0] * width - flow.shape[1] * height) < max(size)
