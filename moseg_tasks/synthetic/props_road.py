"""Surfaces of a road scene: carriageway, verges, lane markings, fronts, trees, poles and sky; saloons and a cyclist.

The camera drives along z in the lane x = 0. The ground is the plane y = 0.
"""

from moseg.tasks.synthetic.paths import Path, Sway
from moseg.tasks.synthetic.props import GroundVector, ground, moving_from, texture
from moseg.tasks.synthetic.scene import Part, Thing
from moseg.tasks.synthetic.shapes import Billboard, Box, Ellipsoid, Plane
from moseg.tasks.synthetic.texture import Texture

SKY_DEPTH = 180.0
"""Distance of the sky at frame 0, m; a hedge stands 40 m before it."""
KERB = 0.06
"""Height of the verges, m."""

Lot = tuple[float, float, float, float, str]
"""A building: nearest and farthest z, distance of its front from the verge's edge and height, m; palette."""


def road(left: float, right: float, seed: int, *, dashes: tuple[float, ...] = ()) -> tuple[Part, ...]:
    """Return a carriageway from x = ``left`` to ``right``, verges beside it, and a hedge and the sky at its end.

    ``dashes`` are the x of broken lines.
    """
    asphalt = texture("tar", seed, 0.03).model_copy(update={"contrast": 0.14})
    paving = texture("plaster", seed + 1, 0.02, "tiles")
    paint = texture("plaster", seed + 2, 0.02)
    reach, width = SKY_DEPTH / 2.0, 40.0
    return (
        ground(asphalt),
        _block((left - width, 0.0, reach), (width, KERB, reach), paving),
        _block((right + width, 0.0, reach), (width, KERB, reach), paving),
        *(_block((x, 0.0, z), (0.07, 0.008, 1.5), paint) for x in dashes for z in range(6, 60, 9)),
        _block((0.0, 0.0, SKY_DEPTH - 40.0), (60.0, 4.5, 2.0), texture("moss", seed + 4, 0.05)),
        _sky(seed + 3),
    )


def fronts(edge: float, side: int, lots: tuple[Lot, ...], seed: int) -> tuple[Part, ...]:
    """Return buildings along the verge at x = ``edge``; ``side`` is -1 left and 1 right of the road."""
    blocks, depth = [], 5.0
    for index, (near, far, setback, height, palette) in enumerate(lots):
        wall = texture(palette, seed + index, 0.045, "windows")
        center = (edge + side * (setback + depth), -height / 2.0, (near + far) / 2.0)
        blocks.append(_block(center, (depth, height / 2.0, (far - near) / 2.0), wall))
    return tuple(blocks)


def tree(at: GroundVector, seed: int, *, height: float = 5.0) -> tuple[Part, ...]:
    """Return a trunk, and a crown made of an ellipsoid and an irregular sheet through it."""
    bark, leaves = texture("timber", seed, 0.008), texture("moss", seed + 1, 0.014)
    leaves = leaves.model_copy(update={"contrast": 0.4})
    x, z = at
    crown = (x, -0.68 * height, z)
    return (
        Part(
            shape=Ellipsoid(size=(0.16, 0.6 * height, 0.16)), texture=bark, position=Path(start=(x, -0.05 * height, z))
        ),
        Part(shape=Ellipsoid(size=(1.0, 0.26 * height, 1.1)), texture=leaves, position=Path(start=crown)),
        Part(
            shape=Billboard(size=(1.25, 0.3 * height), ripples=(0.10, 0.12, 0.10)),
            texture=leaves,
            position=Path(start=crown),
        ),
    )


def pole(at: GroundVector, seed: int, *, height: float = 5.0) -> Part:
    """Return a lamp post or the post of a sign, 14 cm thick."""
    return _block((at[0], -height / 2.0, at[1]), (0.07, height / 2.0, 0.07), texture("slate", seed, 0.01))


def saloon(
    at: GroundVector, paint: str, seed: int, *, heading: float = 0.0, velocity: GroundVector = (0.0, 0.0)
) -> Thing:
    """Return a car 4.2 m long that points along z when ``heading`` is 0: body, cabin, roof, bumpers and wheels."""
    body = texture(paint, seed, 0.014).model_copy(update={"contrast": 0.16})
    glass, rubber = texture("ink", seed + 1, 0.012), texture("ink", seed + 2, 0.006)
    wheel = Ellipsoid(size=(0.12, 0.33, 0.33))
    return Thing(
        parts=(
            Part(shape=Box(size=(0.86, 0.31, 2.05)), texture=body, offset=(0.0, -0.64, 0.0)),
            Part(shape=Ellipsoid(size=(0.76, 0.62, 1.5)), texture=glass, offset=(0.0, -0.88, -0.25)),
            Part(shape=Ellipsoid(size=(0.70, 0.58, 1.38)), texture=body, offset=(0.0, -0.93, -0.25)),
            Part(shape=Box(size=(0.80, 0.09, 2.12)), texture=rubber, offset=(0.0, -0.46, 0.0)),
            *(Part(shape=wheel, texture=rubber, offset=(x, -0.33, z)) for x in (-0.80, 0.80) for z in (-1.3, 1.3)),
        ),
        position=moving_from(at, velocity),
        angles=Path(start=(0.0, heading, 0.0)),
    )


def cyclist(
    at: GroundVector, coat: Texture, trousers: Texture, frame: Texture, *, velocity: GroundVector, cadence: float = 12.0
) -> Thing:
    """Return a rider who crosses along x, 1.8 m tall and 1.7 m long; wheels roll and legs pedal."""
    forward = 1.0 if velocity[0] > 0 else -1.0
    # A wheel of radius 0.34 m turns by the way that it rolls; roll is clockwise in the image.
    roll = Path(velocity=(0.0, 0.0, velocity[0] / 0.34 * 57.29577951308232))
    wheel, tube = Ellipsoid(size=(0.34, 0.34, 0.035)), Box(size=(0.5, 0.035, 0.03))

    def at_place(x: float, height: float, z: float = 0.0) -> Path:
        return Path(start=(forward * x, -height, z))

    def leg(phase: float, z: float) -> Part:
        swing = Path(
            start=(0.0, 0.0, -forward * 12.0), sways=(Sway(amplitude=(0.0, 0.0, 16.0), period=cadence, phase=phase),)
        )
        return Part(
            shape=Ellipsoid(size=(0.09, 0.42, 0.09)),
            texture=trousers,
            position=at_place(-0.18, 0.98, z),
            angles=swing,
            offset=(0.0, 0.36, 0.0),
        )

    def lean(degrees: float) -> Path:
        return Path(start=(0.0, 0.0, forward * degrees))

    return Thing(
        parts=(
            *(Part(shape=wheel, texture=frame, position=at_place(x, 0.34), angles=roll) for x in (-0.52, 0.52)),
            Part(shape=tube, texture=frame, position=at_place(0.0, 0.58), angles=lean(-14.0)),
            Part(
                shape=Ellipsoid(size=(0.17, 0.40, 0.20)), texture=coat, position=at_place(0.02, 1.22), angles=lean(24.0)
            ),
            Part(shape=Ellipsoid(size=(0.12, 0.15, 0.12)), texture=frame, position=at_place(0.22, 1.68)),
            Part(
                shape=Ellipsoid(size=(0.06, 0.32, 0.06)),
                texture=coat,
                position=at_place(0.32, 1.2, -0.2),
                angles=lean(-50.0),
            ),
            leg(0.0, -0.11),
            leg(0.5, 0.11),
        ),
        position=moving_from(at, velocity),
    )


def _block(center: tuple[float, float, float], size: tuple[float, float, float], surface: Texture) -> Part:
    return Part(shape=Box(size=size), texture=surface, position=Path(start=center))


def _sky(seed: int) -> Part:
    clouds = Texture(palette=((208, 219, 233), (214, 224, 236), (222, 230, 238)), texel=0.9, contrast=0.004, seed=seed)
    return Part(shape=Plane(), texture=clouds, position=Path(start=(0.0, 0.0, SKY_DEPTH)))
