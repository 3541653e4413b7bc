"""Samples to train the motion network on: rendered scenes, encoded from their estimated flow."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import FlowParams, SaliencyParams
from moseg.tasks.flow.dis import estimate_flow
from moseg.tasks.frame_grid import reduced_shape
from moseg.tasks.motion_network.encoding import GRID_SIDE, Neighbour, encode_motion
from moseg.tasks.saliency.layers import fit_layers
from moseg.tasks.training_scenes import TrainingScene, draw_scene

SHAPES = ((240, 427),) * 6 + ((320, 427),) * 2 + ((427, 240), (129, 427))
"""Sizes of the frames, by how often they occur: wide, television, portrait, panorama."""


class Sample(NamedTuple):
    """A sample on the network's grid.

    Attributes
    ----------
    channels : float16 (channel, y, x)
        Of `encode_motion`.
    label : uint8 (y, x)
        Share of each pixel that moves on its own, 0..255.
    counts : bool (y, x)
        Whether the label is certain.
    """

    channels: np.ndarray
    label: np.ndarray
    counts: np.ndarray


def draw_sample(seed: int, index: int, shape: tuple[int, int], textures: np.ndarray) -> Sample:
    """Draw sample `index` of those of a `seed`.

    Flow is that of DIS, at random down to full or to half resolution: videos have more sizes than the scenes.

    Parameters
    ----------
    seed, index : int
    shape : tuple of int
        Height and width of the frames, px.
    textures : uint8 (count, side, side, 3)
        Of `paint_textures`.

    Returns
    -------
    Sample
    """
    rng = np.random.default_rng([seed, index])
    preset = "fine" if rng.random() < 0.3 else "medium"
    return encode_scene(
        draw_scene(rng, shape, textures), FlowParams(preset=preset, search_side=16, coarse_side=0), SaliencyParams()
    )


def encode_scene(scene: TrainingScene, flow: FlowParams, saliency: SaliencyParams) -> Sample:
    """Encode a scene as the pipeline encodes a video, with layers as the background."""
    before, middle, after = scene.frames
    neighbours = []
    for frame in (before, after):
        there = estimate_flow(middle, frame, flow)
        residual = there - fit_layers(there, saliency).flow
        neighbours.append(Neighbour(frame.astype(np.float32), there, estimate_flow(frame, middle, flow), residual))
    channels = encode_motion(middle.astype(np.float32), *neighbours, saliency)
    grid = reduced_shape(middle.shape[:2], GRID_SIDE)
    label, weight = (
        cv2.resize(image, grid[::-1], interpolation=cv2.INTER_AREA) for image in (scene.label, scene.weight)
    )
    return Sample(channels, np.rint(np.clip(label, 0, 1) * 255).astype(np.uint8), weight > 0.5)
