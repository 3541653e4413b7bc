"""Outlines of things: blobs, animals and people with limbs, vehicles with wheels, poles, trees, fences."""

from typing import NamedTuple

import cv2
import numpy as np


class Part(NamedTuple):
    """A part of a thing.

    Attributes
    ----------
    alpha : uint8 (y, x)
        Coverage of each pixel of the canvas.
    pivot : float64 (2,)
        xy of the joint that it turns about, px.
    swing : float
        How far it turns against the rest in a frame, radians, a standard deviation.
    """

    alpha: np.ndarray
    pivot: np.ndarray
    swing: float


class Place(NamedTuple):
    """Canvas (y, x) of a thing, its middle xy and half of its height, px."""

    canvas: tuple[int, int]
    middle: np.ndarray
    radius: float


def draw_mover(rng: np.random.Generator, place: Place) -> list[Part]:
    """Draw the parts of something that moves, those behind first."""
    kind = rng.choice([_blob, _animal, _person, _vehicle], p=[0.3, 0.3, 0.22, 0.18])
    return kind(rng, place)


def draw_decoy(rng: np.random.Generator, place: Place) -> list[Part]:
    """Draw the parts of something static that stands before the backdrop."""
    kind = rng.choice([_blob, _pole, _tree, _fence, _vehicle, _person], p=[0.25, 0.25, 0.2, 0.1, 0.15, 0.05])
    return [Part(part.alpha, part.pivot, 0.0) for part in kind(rng, place)]


def _blob(rng: np.random.Generator, place: Place) -> list[Part]:
    angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    radius = np.ones(64)
    roughness = rng.uniform(0, 0.5)
    for wave in range(2, 8):
        radius += roughness / wave * rng.normal() * np.cos(wave * angle + rng.uniform(0, 2 * np.pi))
    stretch = 2 ** rng.uniform(-1, 1)
    outline = np.stack([np.cos(angle) * stretch, np.sin(angle)], axis=-1) * np.maximum(radius, 0.15)[:, None]
    return [_polygon(place, _turned(outline, rng.uniform(0, np.pi)))]


def _animal(rng: np.random.Generator, place: Place) -> list[Part]:
    length, depth, leg = rng.uniform(0.9, 1.7), rng.uniform(0.35, 0.6), rng.uniform(0.5, 0.9)
    thick, swing, facing = rng.uniform(0.08, 0.2), rng.uniform(0, 0.12), rng.choice([-1, 1])
    parts = []
    for x in (-0.8, -0.65, 0.65, 0.8):
        hip = np.array([x * length, 0.1])
        foot = _beside(hip, (rng.normal(0, 0.15), leg))
        parts.append(_limb(place, hip, foot, thick, swing))
    tail = np.array([-facing * length, -0.1])
    parts.append(
        _limb(place, tail, _beside(tail, (-facing * rng.uniform(0.1, 0.6), rng.normal(0, 0.3))), 0.06, swing * 2)
    )
    parts.append(_ellipse(place, (0, 0), (length, depth), rng.normal(0, 6)))
    neck = np.array([facing * length * 0.9, -0.15])
    head = _beside(neck, (facing * rng.uniform(0.15, 0.4), -rng.uniform(0.0, 0.8)))
    parts.append(_limb(place, neck, head, rng.uniform(0.15, 0.3), swing / 2))
    parts.append(
        _ellipse(place, head, (rng.uniform(0.2, 0.35), rng.uniform(0.15, 0.25)), rng.uniform(-40, 40), neck, swing / 2)
    )
    return parts


def _person(rng: np.random.Generator, place: Place) -> list[Part]:
    swing, lean = rng.uniform(0, 0.15), rng.normal(0, 0.12)
    hip, neck = np.array([0.0, 0.1]), np.array([lean, -0.6])
    parts = []
    for _ in range(2):
        knee = _beside(hip, (rng.normal(0, 0.15), 0.4))
        parts.append(_limb(place, hip, knee, 0.2, swing))
        parts.append(_limb(place, knee, _beside(knee, (rng.normal(0, 0.15), 0.4)), 0.15, swing * 1.5))
    parts.append(_limb(place, hip, neck, rng.uniform(0.3, 0.45), 0.02))
    for _ in range(2):
        elbow = _beside(neck, (rng.normal(0, 0.25), rng.uniform(0.1, 0.4)))
        parts.append(_limb(place, neck, elbow, 0.13, swing * 1.5))
        parts.append(_limb(place, elbow, _beside(elbow, (rng.normal(0, 0.2), rng.uniform(-0.2, 0.3))), 0.1, swing * 2))
    parts.append(_ellipse(place, _beside(neck, (lean / 2, -0.2)), (0.14, 0.18), 0, neck, 0.03))
    if rng.random() < 0.35:  # something that is ridden
        parts.insert(0, _limb(place, np.array([-0.8, 0.9]), np.array([0.8, 0.9]), rng.uniform(0.05, 0.3), 0.01))
        for x in (-0.6, 0.6):
            parts.insert(0, _ellipse(place, (x, 0.9), (0.35, 0.35), 0, (x, 0.9), 0.2))
    return parts


def _vehicle(rng: np.random.Generator, place: Place) -> list[Part]:
    length, roof = rng.uniform(1.0, 2.4), rng.uniform(0.2, 0.8)
    low, high = 0.6, -0.1
    body = np.array([[-length, low], [-length, high], [-roof * length, high], [-roof * length * 0.8, -0.8]])
    mirrored = body[::-1] * (-1, 1) + (rng.uniform(-0.1, 0.2), 0)
    parts = [_polygon(place, np.concatenate([body, mirrored]))]
    for x in (-0.62 * length, 0.62 * length):
        parts.append(_ellipse(place, (x, low), (0.28, 0.28), 0, (x, low), rng.uniform(0, 0.3)))
    return parts


def _pole(rng: np.random.Generator, place: Place) -> list[Part]:
    half = rng.uniform(0.02, 0.15)
    lean = rng.normal(0, 0.05)
    return [_polygon(place, np.array([[-half, 1], [-half + lean, -3], [half + lean, -3], [half, 1]]))]


def _tree(rng: np.random.Generator, place: Place) -> list[Part]:
    half = rng.uniform(0.05, 0.15)
    parts = [_polygon(place, np.array([[-half, 1], [-half, -0.4], [half, -0.4], [half, 1]]))]
    for _ in range(rng.integers(2, 7)):
        parts.append(_ellipse(place, rng.normal((0, -0.6), 0.3), rng.uniform(0.15, 0.6, 2), rng.uniform(0, 180)))
    return [_joined(parts)]


def _fence(rng: np.random.Generator, place: Place) -> list[Part]:
    step, half = rng.uniform(0.15, 0.5), rng.uniform(0.02, 0.06)
    bars = [
        np.array([[x - half, 1], [x - half, -0.5], [x + half, -0.5], [x + half, 1]]) for x in np.arange(-4, 4, step)
    ]
    bars += [np.array([[-4, y], [4, y], [4, y + 2 * half], [-4, y + 2 * half]]) for y in (-0.4, 0.4)]
    return [_joined([_polygon(place, bar) for bar in bars])]


def _beside(point: np.ndarray, offset: tuple[float, float]) -> np.ndarray:
    return point + np.asarray(offset)


def _joined(parts: list[Part]) -> Part:
    return Part(np.maximum.reduce([part.alpha for part in parts]), parts[0].pivot, 0.0)


def _turned(points: np.ndarray, angle: float) -> np.ndarray:
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])


def _polygon(place: Place, points: np.ndarray) -> Part:
    alpha = np.zeros(place.canvas, np.uint8)
    fixed = np.rint((place.middle + place.radius * points) * 16).astype(np.int32)
    cv2.fillPoly(alpha, [fixed], 255, cv2.LINE_AA, 4)
    return Part(alpha, place.middle, 0.0)


def _ellipse(place: Place, middle, half, degrees: float, pivot=(0.0, 0.0), swing: float = 0.0) -> Part:
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    outline = np.stack([np.cos(angle) * half[0], np.sin(angle) * half[1]], axis=-1)
    alpha = _polygon(place, _turned(outline, np.radians(degrees)) + middle).alpha
    return Part(alpha, place.middle + place.radius * np.asarray(pivot, float), swing)


def _limb(place: Place, start: np.ndarray, end: np.ndarray, thick: float, swing: float) -> Part:
    """Draw a limb from a joint to its end, narrower towards the end."""
    along = end - start
    across = np.array([-along[1], along[0]]) / max(np.hypot(*along), 1e-6) * thick / 2
    outline = np.array([start + across, start - along * 0.1, start - across, end - 0.6 * across, end + 0.6 * across])
    return Part(_polygon(place, outline).alpha, place.middle + place.radius * start, swing)
