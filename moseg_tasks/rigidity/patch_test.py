"""Test of a track by its patch: whether some position of a rigid point explains it as well as the tracked one.

A tracker slips along edges and on bare road. Such a track deviates from every rigid point, but the patch at a rigid
position looks just as much like the one it started from, so that nothing speaks for a motion. Where a near surface
crosses a far one, as a pole before a meadow, a corner of both moves like neither: there each half of the patch may have
a rigid position of its own, one of them perhaps far behind the other. And what is faint and stands still in the picture
may be no thing of the scene at all, but a reflection in the windscreen, or bare road of which a codec repeats what it
showed before. Both stay for longer than a pair of frames takes; a dark, plain leg that crosses the frame does not.
"""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.parallax import Parallax

_BESIDE = np.array([[x, y] for y in (-0.25, 0, 0.25) for x in (-0.25, 0, 0.25)], np.float32)
"""Offsets of a tracked position to a quarter of a pixel, px."""
_REFINEMENTS = (0.5, 0.25)
"""Steps along the epipolar line after the first search at whole pixels, px."""
_FLOOR = 1e-6
"""Squared grey levels; in a frame without contrast noise is zero, and all differences are."""
_MARKED, _FAINT = 90, 0.6
"""Percentile of the contrasts of a frame, and the share of it that what is faint has at most."""
_AWAY = 4
"""Least distance of a place that stands still in the picture from all rigid positions, px."""
UNBOUNDED = 1e4
"""A parallax that no track has, px: the largest of a rigid point that may be as near as it likes."""
_TOGETHER = 64
"""Tracks whose patches are compared at a time: they fit into the processor's cache."""


class AllowedParallax(NamedTuple):
    """Least and largest parallax of a rigid point for each of N tracks, float64 (N,), px; `UNBOUNDED` if it is known
    of nothing that it is too near."""

    least: np.ndarray
    largest: np.ndarray

    def clip(self, parallax: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Clip parallaxes (M, K) of the tracks `rows`."""
        least = self.least[rows, None]
        return np.clip(parallax, least, np.maximum(self.largest[rows, None], least))


def compare_patches(
    image0: np.ndarray,
    image1: np.ndarray,
    points0: np.ndarray,
    points1: np.ndarray,
    parallax: Parallax,
    allowed: AllowedParallax,
    rows: np.ndarray,
    params: RigidityParams,
    others: Sequence[np.ndarray] = (),
) -> np.ndarray:
    """Compare the patch of each track at its tracked position with that at the best rigid position.

    Parameters
    ----------
    image0, image1 : uint8 (y, x)
        Blurred grey frames.
    points0, points1 : float64 (N, 2)
        xy of the tracks in both frames, px.
    parallax : Parallax
        Of these tracks.
    allowed : AllowedParallax
        Of these tracks.
    rows : intp (M,)
        Tracks to test.
    params : RigidityParams
    others : sequence of uint8 (y, x), optional
        Blurred grey frames from well before and well after the pair.

    Returns
    -------
    float64 (M, 2)
        (m1 - m0) / (noise² + m0) in -1..`params.test_limit`, with m0 and m1 the mean squared differences of patches
        without their means at the tracked position and at the best rigid one: 0 where a rigid point explains the patch
        as well, 1 where it is worse by as much as the tracked position itself. Of a faint patch that began 4 px or more
        away from every rigid position, m1 is no larger than the difference at the place where it began, to a quarter of
        a pixel: that in the second frame or the least in `others`, if there are any, whichever is larger. In the second
        column m1 is no larger than `params.test_two_surfaces` times the mean of two halves of the patch, each at its
        best rigid position, which may also be one of `params.test_behind` between the farthest static point and the
        track if that is unbounded. The noise is `params.test_noise`, but at most `params.test_contrast` times the mean
        contrast of the first frame; a faint patch has a contrast below `params.test_still_contrast` times the noise,
        and below 0.6 times the contrast that a tenth of the frame exceeds. Contrast is the standard deviation in a
        patch.
    """
    image0, image1 = image0.astype(np.float32), image1.astype(np.float32)
    size = params.test_half
    offsets = np.arange(-size, size + 1, dtype=np.float32)
    offset_x, offset_y = (axis.ravel() for axis in np.meshgrid(offsets, offsets))
    parts = _parts(offset_x, offset_y)
    contrast = _contrast(image0, 2 * size + 1)
    noise = min(params.test_noise, params.test_contrast * float(contrast.mean()))
    faint = min(params.test_still_contrast * noise, _FAINT * float(np.percentile(contrast, _MARKED)))
    away = _away_from_rigid(points0[rows], parallax, allowed, rows)

    @cache
    def compared_with() -> list[np.ndarray]:
        return [image1, *(image.astype(np.float32) for image in others)]

    result = np.zeros((len(rows), 2))
    for start in range(0, len(rows), _TOGETHER):
        part = rows[start : start + _TOGETHER]
        patches = _patches(image0, points0[part][:, None], offset_x, offset_y)

        def differ(positions, patches=patches, image=image1):
            return _differences(patches, _patches(image, positions, offset_x, offset_y), parts)

        tracked = differ(points1[part][:, None] + _BESIDE)[..., 0].min(axis=1)
        whole, *halves = _best_rigid(differ, parallax, allowed, part, params).T
        pairs = [(half0 + half1) / 2 for half0, half1 in zip(halves[::2], halves[1::2], strict=True)]
        may_be_still = (patches[:, 0].std(axis=1) < faint) & (away[start : start + _TOGETHER] >= _AWAY)
        if may_be_still.any():
            places = points0[part[may_be_still]][:, None] + _BESIDE
            still, *at_other_times = (
                differ(places, patches[may_be_still], image)[..., 0].min(axis=1) for image in compared_with()
            )
            if at_other_times:
                still = np.maximum(still, np.min(at_other_times, axis=0))
            whole[may_be_still] = np.minimum(whole[may_be_still], still)
        rigid = np.stack([whole, np.minimum(whole, params.test_two_surfaces * np.min(pairs, axis=0))], axis=1)
        result[start : start + _TOGETHER] = (rigid - tracked[:, None]) / (noise**2 + tracked[:, None] + _FLOOR)
    return np.clip(result, -1, params.test_limit)


def _away_from_rigid(places: np.ndarray, parallax: Parallax, allowed: AllowedParallax, rows: np.ndarray) -> np.ndarray:
    """Return how far places (M, 2) are from the nearest rigid position of each track of `rows`, float64 (M,), px."""
    rotated, towards = parallax.rotated[rows], parallax.towards[rows]
    along = np.sum((places - rotated) * towards, axis=1)
    along = allowed.clip(along[:, None], rows)
    return np.linalg.norm(rotated + along * towards - places, axis=1)


def _best_rigid(differ, parallax: Parallax, allowed: AllowedParallax, rows, params: RigidityParams) -> np.ndarray:
    """Return the least difference (M, part) over rigid positions: whole pixels, then along and across the line."""
    base, towards = parallax.rotated[rows][:, None], parallax.towards[rows][:, None]
    aside = np.stack([towards[..., 1], -towards[..., 0]], axis=-1) * params.test_across
    track = np.arange(len(rows))
    span = np.arange(-params.test_span, params.test_span + 1)
    steps = allowed.clip(parallax.along[rows, None] + span, rows)
    difference = differ(base + steps[..., None] * towards)
    best = steps[track, difference[..., 0].argmin(axis=1)][:, None]
    least = difference.min(axis=1)
    beside = np.array([-1, 0, 1])
    # Around the best position of the whole patch only: a half that prefers another one is compared at whole pixels.
    for step in _REFINEMENTS:
        steps = allowed.clip(best + step * beside, rows)
        on_line = base + steps[..., None] * towards
        difference = differ((on_line[:, :, None] + beside[:, None] * aside[:, None]).reshape(len(rows), -1, 2))
        best = steps[track, difference[..., 0].argmin(axis=1) // len(beside)][:, None]
        least = np.minimum(least, difference.min(axis=1))
    free = np.flatnonzero(allowed.largest[rows] >= UNBOUNDED)
    if params.test_behind and len(free):
        steps = _behind(parallax, allowed, rows, params)
        behind = differ(base + steps[..., None] * towards).min(axis=1)
        least[free, 1:] = np.minimum(least[free, 1:], behind[free, 1:])
    return least


def _behind(parallax: Parallax, allowed: AllowedParallax, rows: np.ndarray, params: RigidityParams) -> np.ndarray:
    """Return parallaxes (M, K) from that of the farthest static point to those near the track, px.

    One after the other at whole pixels first, then in equal steps: what is behind a near thing mostly is the ground.
    """
    fine = params.test_behind // 2
    farthest = allowed.least[rows, None]
    far = np.maximum(parallax.along[rows, None] - params.test_span - farthest - fine, 0)
    steps = np.arange(1, params.test_behind - fine + 1) / (params.test_behind - fine)
    near = np.tile(np.arange(fine), (len(rows), 1))
    return allowed.clip(farthest + np.concatenate([near, fine + far * steps], axis=1), rows)


def _contrast(image: np.ndarray, side: int) -> np.ndarray:
    """Return the standard deviation float32 (y, x) in squares of `side` px around the pixels of an image float32."""
    mean, square = (cv2.blur(each, (side, side)) for each in (image, image * image))
    return np.sqrt(np.maximum(square - mean * mean, 0))


def _parts(offset_x: np.ndarray, offset_y: np.ndarray) -> np.ndarray:
    """Return masks float32 (part, P): the whole patch, then both sides of four lines through its centre."""
    sides = [np.ones(len(offset_x), bool)]
    for distance in (offset_x, offset_y, offset_x + offset_y, offset_x - offset_y):
        sides += [distance < 0, distance > 0]
    return np.array(sides, np.float32)


def _patches(image: np.ndarray, positions: np.ndarray, offset_x: np.ndarray, offset_y: np.ndarray) -> np.ndarray:
    """Return patches float32 (M, K, P) around positions (M, K, 2), xy, linear between pixels."""
    x, y = positions.reshape(-1, 2).astype(np.float32).T
    around_x, around_y = x[:, None] + offset_x, y[:, None] + offset_y
    patches = cv2.remap(image, around_x, around_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return patches.reshape(*positions.shape[:2], -1)


def _differences(patches0: np.ndarray, patches1: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Return the variance (M, K, part) of the differences of patches (M, 1, P) and (M, K, P) over parts (part, P)."""
    apart = patches1 - patches0
    size = parts.sum(axis=1)
    mean = apart @ parts.T / size
    return np.maximum((apart * apart) @ parts.T / size - mean * mean, 0)
