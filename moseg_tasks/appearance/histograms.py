"""Histograms of a section's moving and static colours and textures, and the flow's consistency where it moves."""

import math
from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import AppearanceParams, ForegroundParams
from moseg.tasks.saliency.logits import motion_logit, probability

_BYTES = np.arange(256)
_GREY = 128  # a and b of a colour without chroma, as OpenCV keeps them in a byte


def colour_bins(image: np.ndarray, params: AppearanceParams) -> np.ndarray:
    """Return the bin of each pixel's colour and texture.

    Colour has `levels` each of L, a and b, which are perceptually uniform; texture is the deviation of L around the
    pixel, whose bins grow with it.

    Parameters
    ----------
    image : uint8 (y, x, 3)
        RGB.
    params : AppearanceParams

    Returns
    -------
    bins : uint16 (y, x)
        Flat places in a histogram of `histogram_shape`.
    """
    lightness, a, b = cv2.split(cv2.cvtColor(image, cv2.COLOR_RGB2LAB))
    levels, texture = params.levels, _texture_bins(lightness, params)
    light = _BYTES * levels // 256
    # Half a byte off the edge between two bins, because grey lies on that edge.
    chroma = np.floor((_BYTES - _GREY + 0.5) * levels / params.chroma_range + levels / 2).clip(0, levels - 1)
    steps = np.array([levels**2, levels, 1]) * params.texture_levels
    tables = ((step * side).astype(np.uint16) for step, side in zip(steps, (light, chroma, chroma), strict=True))
    return sum((np.take(table, side) for table, side in zip(tables, (lightness, a, b), strict=True)), start=texture)


def histogram_shape(params: AppearanceParams) -> tuple[int, int, int, int]:
    """Return how many bins a histogram has of L, a, b and texture."""
    return (*(params.levels,) * 3, params.texture_levels)


def _texture_bins(lightness: np.ndarray, params: AppearanceParams) -> np.ndarray:
    """Return the bin uint16 (y, x) of the standard deviation of L in a Gaussian window."""
    if params.texture_levels == 1:
        return np.zeros(lightness.shape, np.uint16)

    def blurred(values: np.ndarray) -> np.ndarray:
        return cv2.GaussianBlur(values, (0, 0), params.texture_scale)

    levels = lightness.astype(np.float32)
    mean = blurred(levels)
    deviation = np.sqrt(np.maximum(blurred(levels * levels) - mean * mean, 0))
    place = np.sqrt(deviation * np.float32(1 / params.texture_range)) * np.float32(params.texture_levels)
    return np.minimum(place, params.texture_levels - 1).astype(np.uint16)


class ColourCount(NamedTuple):
    """Weighted counts over frames; counts of several runs of frames add up.

    Attributes
    ----------
    moving, static : float64 (bin,)
        Weights of the colours and textures that move and of those in the background.
    moving_textures, static_textures : float64 (bin,)
        The same of colours that are on both sides of a frame: each colour has the same weight on both sides.
    reliability : float
        Summed flow consistency of salient pixels.
    weight : float
        Weight of that sum.
    """

    moving: np.ndarray
    static: np.ndarray
    moving_textures: np.ndarray
    static_textures: np.ndarray
    reliability: float
    weight: float


def count_sides(bins: np.ndarray, moving: np.ndarray, static: np.ndarray, params: AppearanceParams) -> ColourCount:
    """Count the colours and textures of pixels of one frame, whose weights on both sides are given.

    A thing that comes near changes its texture, and a background does. Textures are therefore compared only in pixels
    of one colour and one frame: of a colour with the weights m and s on the two sides, each side has the weight
    m s / (m + s) in the counts of textures.

    Parameters
    ----------
    bins : uint16 (pixel,)
        Of `colour_bins`.
    moving, static : float (pixel,)
        Weights.
    params : AppearanceParams

    Returns
    -------
    ColourCount
        Its `weight` is the sum of `moving`.
    """
    size = math.prod(histogram_shape(params))
    sides = np.stack([np.bincount(bins, weights, size) for weights in (moving, static)])
    by_texture = sides.reshape(2, -1, params.texture_levels)
    colours = by_texture.sum(axis=2, keepdims=True)
    shares = colours[::-1] / np.maximum(colours.sum(axis=0), np.finfo(float).tiny)
    textures = (by_texture * shares).reshape(2, size)
    return ColourCount(*sides, *textures, 0.0, float(sides[0].sum()))


def count_colours(
    bins: np.ndarray,
    strict: np.ndarray,
    reliability: np.ndarray,
    misfit: np.ndarray,
    params: AppearanceParams,
    foreground: ForegroundParams,
) -> ColourCount:
    """Count the colours of one frame, each pixel weighted by its probability to move or to be static.

    Colours are only learnt from what moves rigidly and consistently, so that the colour of moving water is not learnt.

    Parameters
    ----------
    bins : uint16 (y, x)
        Of `colour_bins`.
    strict : float32 (y, x)
        Accumulated strict saliency, 0..1.
    reliability : float32 (y, x)
        Accumulated consistency of the flow, 0..1.
    misfit : float32 (y, x)
        Accumulated misfit to the own motion.
    params : AppearanceParams
    foreground : ForegroundParams
        Its `threshold` and `sharpness` are read.

    Returns
    -------
    ColourCount
    """
    logit = motion_logit(strict, foreground.threshold, foreground.sharpness)
    moves = probability(logit - np.float32(params.misfit_weight) * misfit)
    moving = moves**params.moving_sharpness * reliability**2
    unreliable = np.float32(params.unreliable_static) * (1 - reliability)
    static = np.maximum((1 - moves) ** params.static_sharpness, unreliable)
    salient = strict > foreground.threshold
    core = probability(logit[salient]) ** params.moving_sharpness
    counted = count_sides(bins.ravel(), moving.ravel(), static.ravel(), params)
    return counted._replace(reliability=float(core @ reliability[salient]), weight=float(core.sum()))
