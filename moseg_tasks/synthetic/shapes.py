"""Surfaces in local coordinates: intersection with rays, bending and texture coordinates.

A ray is ``origin + depth * direction``. ``origin`` is three floats; ``direction`` is three arrays that broadcast
against each other. Only + - * / sqrt act on pixels, so that every IEEE-754 machine gives the same bits.
"""

from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.tasks.synthetic.paths import STILL, Path, Vector

NEAREST_DEPTH = 0.05
"""Surfaces closer to the camera than this are invisible, metres."""
_TINY = 1e-30

Rays = tuple[np.ndarray, np.ndarray, np.ndarray]


class Chart(NamedTuple):
    """Texture coordinates and normals of surface points.

    Attributes
    ----------
    u, v : float64 (N,)
        Metres along the surface.
    normal : float64 (N, 3)
        Not of unit length.
    """

    u: np.ndarray
    v: np.ndarray
    normal: np.ndarray


class Plane(Frozen):
    """The infinite plane z = 0."""

    kind: Literal["plane"] = "plane"

    @property
    def extent(self) -> Vector | None:
        """Half sizes of the box that bounds the surface, metres; None where it has no bound."""
        return None

    def hit(self, origin: np.ndarray, direction: Rays) -> np.ndarray:
        """Return the depth at which each ray meets the surface, infinite where it does not."""
        return _in_front(-origin[2] / _nonzero(direction[2]))

    def chart(self, points: np.ndarray) -> Chart:
        """Return texture coordinates and normals of material points, float64 (N, 3)."""
        return Chart(points[:, 0], points[:, 1], np.broadcast_to([0.0, 0.0, 1.0], points.shape))


class Billboard(Frozen):
    """A flat piece of the plane z = 0 whose outline is irregular and which may bend within its plane.

    The outline is ``(x / a)² + (y / b)² < (1 + ripple_3 cos 3 theta + ripple_5 cos 5 theta + ripple_8 cos 8 theta)²``.
    Bending moves the material point (x, y) to ``(x + c1 h + c2 h² + c3 h³, y)`` with h = (b - y) / 2b the height above
    the lower edge, from 0 to 1, and (c1, c2, c3) the path ``bend`` in metres.
    """

    kind: Literal["billboard"] = "billboard"
    size: tuple[float, float] = Field(description="half width a and half height b, m")
    ripples: Vector = Field((0.12, 0.08, 0.05), description="relative height of the outline's harmonics 3, 5 and 8")
    bend: Path = STILL

    @property
    def extent(self) -> Vector | None:
        """Half sizes of the box that bounds the unbent surface, metres."""
        reach = 1.0 + sum(abs(ripple) for ripple in self.ripples)
        return (self.size[0] * reach, self.size[1] * reach, 0.0)

    def hit(self, origin: np.ndarray, direction: Rays, bend: Vector = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return the depth at which each ray meets the bent surface, infinite where it does not."""
        depth = _in_front(-origin[2] / _nonzero(direction[2]))
        reached = np.where(np.isfinite(depth), depth, 0.0)
        y = origin[1] + reached * direction[1]
        x = origin[0] + reached * direction[0] - self._shift(y, bend)
        return np.where(self._inside(x, y), depth, np.inf)

    def bent(self, points: np.ndarray, bend: Vector, sign: float = 1.0) -> np.ndarray:
        """Move material points by the bend (``sign`` 1) or back (-1)."""
        moved = points.copy()
        moved[:, 0] += sign * self._shift(points[:, 1], bend)
        return moved

    def chart(self, points: np.ndarray) -> Chart:
        """Return texture coordinates and normals of material points, float64 (N, 3)."""
        return Chart(points[:, 0], points[:, 1], np.broadcast_to([0.0, 0.0, 1.0], points.shape))

    def _shift(self, y: np.ndarray, bend: Vector) -> np.ndarray:
        height = (self.size[1] - y) / (2.0 * self.size[1])
        return ((bend[2] * height + bend[1]) * height + bend[0]) * height

    def _inside(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        x, y = x / self.size[0], y / self.size[1]
        square = x * x + y * y
        cosine = x / np.sqrt(np.maximum(square, _TINY))
        # Chebyshev polynomials of cos theta: arctan2 and cos would differ in the last bit between processors.
        c2 = 2.0 * cosine * cosine - 1.0
        c3 = 2.0 * cosine * c2 - cosine
        c4 = 2.0 * c2 * c2 - 1.0
        c5 = 2.0 * cosine * c4 - c3
        c8 = 2.0 * c4 * c4 - 1.0
        radius = 1.0 + self.ripples[0] * c3 + self.ripples[1] * c5 + self.ripples[2] * c8
        return square < radius * radius


class Box(Frozen):
    """The surface of a box about the origin, seen from outside."""

    kind: Literal["box"] = "box"
    size: Vector = Field(description="half sizes, m")

    @property
    def extent(self) -> Vector | None:
        """Half sizes of the box that bounds the surface, metres."""
        return self.size

    def hit(self, origin: np.ndarray, direction: Rays) -> np.ndarray:
        """Return the depth at which each ray enters the box, infinite where it does not."""
        enter, leave = -np.inf, np.inf
        for o, d, half in zip(origin, direction, self.size, strict=True):
            d = _nonzero(d)
            first, second = (-half - o) / d, (half - o) / d
            enter = np.maximum(enter, np.minimum(first, second))
            leave = np.minimum(leave, np.maximum(first, second))
        return np.where(enter < leave, _in_front(enter), np.inf)

    def chart(self, points: np.ndarray) -> Chart:
        """Return texture coordinates and normals of material points, float64 (N, 3)."""
        scaled = points / np.array(self.size)
        face = np.argmax(np.abs(scaled), axis=1)
        return _cube_chart(points, face, np.eye(3)[face] * np.sign(scaled))


class Ellipsoid(Frozen):
    """The surface of an ellipsoid about the origin, seen from outside."""

    kind: Literal["ellipsoid"] = "ellipsoid"
    size: Vector = Field(description="radii, m")

    @property
    def extent(self) -> Vector | None:
        """Half sizes of the box that bounds the surface, metres."""
        return self.size

    def hit(self, origin: np.ndarray, direction: Rays) -> np.ndarray:
        """Return the depth at which each ray enters the ellipsoid, infinite where it does not."""
        o = [value / radius for value, radius in zip(origin, self.size, strict=True)]
        d = [value / radius for value, radius in zip(direction, self.size, strict=True)]
        a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
        b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2]
        c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - 1.0
        discriminant = b * b - a * c
        enter = (-b - np.sqrt(np.maximum(discriminant, 0.0))) / a
        return np.where(discriminant > 0.0, _in_front(enter), np.inf)

    def chart(self, points: np.ndarray) -> Chart:
        """Return texture coordinates and normals of material points, float64 (N, 3)."""
        radii = np.array(self.size)
        face = np.argmax(np.abs(points / radii), axis=1)
        return _cube_chart(points, face, points / (radii * radii))


Shape = Annotated[Plane | Billboard | Box | Ellipsoid, Field(discriminator="kind")]


def _cube_chart(points: np.ndarray, face: np.ndarray, normal: np.ndarray) -> Chart:
    """Return texture coordinates from the two axes across the dominant one, different on each of the six faces."""
    rows = np.arange(len(points))
    across, down = np.array([2, 0, 0])[face], np.array([1, 2, 1])[face]
    # A step that is not a multiple of a texture's period gives opposite faces different images.
    step = 0.37 * (2 * face + (points[rows, face] > 0))
    return Chart(points[rows, across] + step, points[rows, down] + step, normal)


def _in_front(depth: np.ndarray) -> np.ndarray:
    return np.where(depth > NEAREST_DEPTH, depth, np.inf)


def _nonzero(direction: np.ndarray) -> np.ndarray:
    return np.where(direction == 0.0, _TINY, direction)
