"""Selection of the background model of a section from a few of its frame pairs."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.camera import fit_camera_motion, split_flow
from moseg.tasks.saliency.gric import gric
from moseg.tasks.saliency.ground import Ground, fit_ground
from moseg.tasks.saliency.layers import fit_layers

_TWO_FLOW_LAYERS = {"dimension": 2, "num_parameters": 12}
_RIGID_SCENE = {"dimension": 3, "num_parameters": 5}


class BackgroundChoice(NamedTuple):
    """The background model of frames in a row, and the evidence for it.

    Attributes
    ----------
    model : "layers" or "rigid"
        One or two affine layers, or a static scene of any depth on a ground plane.
    focal : float
        Focal length in longer sides of the frame, the likeliest under rigid motion.
    ground_share : float
        Median share of the frame's lower part that lies on one plane.
    nearer_below : float
        Share of the pairs in which that plane's parallax grows towards the lower border by more than the tolerance.
    tilt : float
        Median of its slope across the frame over its slope down the frame.
    gain : float
        GRIC per pixel of the layers less that of the rigid scene, mean over the pairs; 0 if there is no such ground.
    """

    model: Literal["layers", "rigid"] = "layers"
    focal: float = 1.0
    ground_share: float = 0.0
    nearer_below: float = 0.0
    tilt: float = 0.0
    gain: float = 0.0


LAYERS = BackgroundChoice()
"""The default background."""


def choose_background(flows: Sequence[np.ndarray], params: SaliencyParams) -> BackgroundChoice:
    """Choose a rigid scene if it explains the pairs better than layers and has a level ground, else layers.

    The flow of a panning camera also agrees with a rigid scene, with meaningless depth. Such depth has no ground: a
    level plane in the frame's lower part whose inverse depth grows towards the lower border in most pairs.

    Parameters
    ----------
    flows : sequence of float32 (y, x, 2)
        Flow of frame pairs spread over the frames, px/frame of the working grid.
    params : SaliencyParams

    Returns
    -------
    BackgroundChoice
    """
    if params.background == "layers" or not flows:
        return LAYERS
    if params.background == "auto" and not _may_have_ground(flows, params):
        return LAYERS
    focal = _choose_focal(flows, params)
    pairs, across, grounds = [], [], []
    for flow in flows:
        motion = fit_camera_motion(flow, focal, params)
        if motion is None:
            continue
        parts = split_flow(flow, motion)
        pairs.append(flow)
        across.append(_samples(parts.across, params))
        grounds.append(fit_ground(parts.along / parts.reach, parts.reach, params))
    if not pairs:
        return LAYERS
    choice = BackgroundChoice("rigid", focal, *_ground_evidence(grounds, len(flows), params))
    if params.background == "rigid":
        return choice
    if not _has_ground(choice, params):
        return choice._replace(model="layers")
    gains = [_gain(flow, residual, params) for flow, residual in zip(pairs, across, strict=True)]
    choice = choice._replace(gain=float(np.mean(gains)))
    return choice if choice.gain > 0 else choice._replace(model="layers")


def _may_have_ground(flows: Sequence[np.ndarray], params: SaliencyParams) -> bool:
    """Check whether inverse depth increases towards the lower border in enough pairs, at the likeliest focal length.

    For a ground it does at any focal length that is roughly right, so the others need not be tried.
    """
    focal = params.focals[int(np.argmin(np.abs(np.log(params.focals))))]
    nearer = 0
    for flow in flows:
        motion = fit_camera_motion(flow, focal, params)
        if motion is not None:
            parts = split_flow(flow, motion)
            nearer += fit_ground(parts.along / parts.reach, parts.reach, params).approach > params.ground_tolerance
    return nearer >= params.ground_hint * len(flows)


def _has_ground(choice: BackgroundChoice, params: SaliencyParams) -> bool:
    return (
        choice.ground_share >= params.ground_share
        and choice.nearer_below >= params.ground_agreement
        and choice.tilt <= params.ground_tilt
    )


def _ground_evidence(grounds: list[Ground], num_pairs: int, params: SaliencyParams) -> tuple[float, float, float]:
    """Return the ground's share, the share of all pairs in which it is nearer below, and its tilt."""
    return (
        float(np.median([ground.share for ground in grounds])),
        sum(ground.approach > params.ground_tolerance for ground in grounds) / num_pairs,
        float(np.median([ground.tilt for ground in grounds])),
    )


def _choose_focal(flows: Sequence[np.ndarray], params: SaliencyParams) -> float:
    """Choose, among the focal lengths nearly as good as the best, the one nearest to the frame's longer side.

    Only a camera that rotates and translates determines its focal length; otherwise all are about as good.
    """
    cost = np.zeros(len(params.focals))
    for flow in flows:
        for index, focal in enumerate(params.focals):
            motion = fit_camera_motion(flow, focal, params)
            residual = 1.0
            if motion is not None:
                across = split_flow(flow, motion, params.gric_step).across
                residual = float(np.mean(np.minimum((across / params.focal_residual) ** 2, 1)))
            cost[index] += residual / len(flows)
    good = np.flatnonzero(cost <= cost.min() + params.focal_slack)
    return params.focals[good[np.argmin(np.abs(np.log(np.array(params.focals)[good])))]]


def _gain(flow: np.ndarray, across: np.ndarray, params: SaliencyParams) -> float:
    """Return the GRIC per pixel of the layers less that of the rigid scene."""
    layers = gric(_samples(fit_layers(flow, params).residual, params), params.gric_noise, **_TWO_FLOW_LAYERS)
    return layers - gric(across, params.gric_noise, **_RIGID_SCENE)


def _samples(image: np.ndarray, params: SaliencyParams) -> np.ndarray:
    """Return every `gric_step`-th pixel: neighbours in a flow field are not independent data."""
    return image[:: params.gric_step, :: params.gric_step].ravel()
