"""Things and backdrops of scenes: crates, pillars, bushes, balls, cars, walkers, rooms and streets.

The ground is the plane y = 0. Props stand on it at (x, z); ``velocity`` is (x, z) in metres per frame.
"""

from moseg.tasks.synthetic.paths import Path, Sway, Vector
from moseg.tasks.synthetic.scene import Part, Thing
from moseg.tasks.synthetic.shapes import Billboard, Box, Ellipsoid, Plane
from moseg.tasks.synthetic.texture import Texture

PALETTES = {
    "asphalt": ((70, 72, 78), (128, 126, 122), (190, 188, 180)),
    "brick": ((150, 74, 52), (196, 112, 84), (94, 46, 38)),
    "bronze": ((120, 82, 30), (206, 158, 74), (60, 40, 20)),
    "coral": ((236, 110, 84), (250, 176, 140), (150, 40, 60)),
    "grass": ((60, 92, 40), (134, 158, 72), (200, 190, 110)),
    "indigo": ((48, 52, 128), (112, 120, 200), (230, 210, 120)),
    "ink": ((34, 36, 42), (56, 60, 68), (84, 90, 98)),
    "moss": ((36, 62, 30), (98, 128, 58), (182, 190, 96)),
    "navy": ((34, 52, 98), (58, 84, 136), (150, 168, 200)),
    "plaster": ((176, 168, 150), (224, 216, 200), (124, 116, 104)),
    "ruby": ((132, 20, 26), (172, 40, 40), (224, 160, 150)),
    "sand": ((172, 142, 98), (222, 196, 150), (120, 92, 62)),
    "scarlet": ((150, 20, 30), (222, 62, 52), (250, 214, 190)),
    "silver": ((150, 154, 158), (188, 190, 192), (96, 100, 106)),
    "slate": ((66, 84, 100), (124, 146, 160), (206, 214, 216)),
    "straw": ((206, 170, 62), (244, 220, 130), (122, 86, 30)),
    "tar": ((84, 84, 87), (108, 107, 105), (140, 138, 134)),
    "teal": ((14, 98, 104), (70, 176, 168), (224, 240, 214)),
    "timber": ((112, 76, 46), (176, 130, 84), (70, 46, 30)),
    "violet": ((92, 40, 112), (170, 104, 186), (240, 200, 230)),
    "white": ((196, 198, 198), (222, 222, 220), (150, 152, 156)),
}

GroundVector = tuple[float, float]


def texture(palette: str, seed: int, texel: float = 0.012, pattern: str = "blotches") -> Texture:
    """Return a texture in the colours of a named palette."""
    return Texture(palette=PALETTES[palette], seed=seed, texel=texel, pattern=pattern)


def moving_from(
    at: GroundVector,
    velocity: GroundVector = (0.0, 0.0),
    height: float = 0.0,
    sways: tuple[Sway, ...] = (),
    climb: float = 0.0,
) -> Path:
    """Return a path that starts ``height`` metres above the ground at (x, z) and rises ``climb`` metres a frame."""
    return Path(start=(at[0], -height, at[1]), velocity=(velocity[0], -climb, velocity[1]), sways=sways)


def crate(
    at: GroundVector,
    size: Vector,
    surface: Texture,
    *,
    yaw: float = 20.0,
    velocity: GroundVector = (0.0, 0.0),
    spin: float = 0.0,
) -> Thing:
    """Return a box of half sizes ``size`` on the ground, turned by ``yaw`` and turning by ``spin`` degrees a frame."""
    return Thing(
        parts=(Part(shape=Box(size=size), texture=surface),),
        position=moving_from(at, velocity, size[1]),
        angles=Path(start=(0.0, yaw, 0.0), velocity=(0.0, spin, 0.0)),
    )


def bush(at: GroundVector, size: GroundVector, surface: Texture, *, yaw: float = 0.0) -> Thing:
    """Return a flat bush with an irregular outline, half width and height ``size``, its lower edge near the ground."""
    return Thing(
        parts=(Part(shape=Billboard(size=size, ripples=(0.10, 0.14, 0.09)), texture=surface),),
        position=moving_from(at, height=0.92 * size[1]),
        angles=Path(start=(0.0, yaw, 0.0)),
    )


def ball(
    at: GroundVector,
    radius: float,
    surface: Texture,
    *,
    height: float,
    velocity: GroundVector = (0.0, 0.0),
    bounce: float = 0.0,
    climb: float = 0.0,
) -> Thing:
    """Return a ball with its centre ``height`` above the ground, oscillating vertically by ``bounce`` metres."""
    sways = (Sway(amplitude=(0.0, -bounce, 0.0), period=16.0),) if bounce else ()
    return Thing(
        parts=(Part(shape=Ellipsoid(size=(radius, radius, radius)), texture=surface),),
        position=moving_from(at, velocity, height, sways, climb),
    )


def car(
    at: GroundVector, paint: Texture, glass: Texture, *, yaw: float = 0.0, velocity: GroundVector = (0.0, 0.0)
) -> Thing:
    """Return a car 3.9 m long that points along z when ``yaw`` is 0: body, cabin and four wheels, all rigid."""
    wheel = Ellipsoid(size=(0.12, 0.33, 0.33))
    return Thing(
        parts=(
            Part(shape=Box(size=(0.85, 0.34, 1.95)), texture=paint, offset=(0.0, -0.62, 0.0)),
            Part(shape=Box(size=(0.72, 0.28, 1.0)), texture=glass, offset=(0.0, -1.2, -0.2)),
            *(Part(shape=wheel, texture=glass, offset=(x, -0.33, z)) for x in (-0.82, 0.82) for z in (-1.25, 1.25)),
        ),
        position=moving_from(at, velocity),
        angles=Path(start=(0.0, yaw, 0.0)),
    )


def walker(
    at: GroundVector,
    coat: Texture,
    trousers: Texture,
    *,
    velocity: GroundVector,
    stride: float = 26.0,
    swing: float = 26.0,
) -> Thing:
    """Return a person 1.75 m tall seen from the side, whose legs and arms swing once in ``stride`` frames."""

    def limb(shape: Vector, surface: Texture, hip: Vector, phase: float) -> Part:
        turn = Path(sways=(Sway(amplitude=(0.0, 0.0, swing), period=stride, phase=phase),))
        offset = (0.0, shape[1], 0.0)
        return Part(shape=Ellipsoid(size=shape), texture=surface, position=Path(start=hip), angles=turn, offset=offset)

    return Thing(
        parts=(
            Part(shape=Ellipsoid(size=(0.24, 0.40, 0.22)), texture=coat, offset=(0.0, -1.16, 0.0)),
            Part(shape=Ellipsoid(size=(0.12, 0.15, 0.13)), texture=trousers, offset=(0.02, -1.64, 0.0)),
            limb((0.11, 0.44, 0.11), trousers, (0.0, -0.88, -0.10), 0.0),
            limb((0.11, 0.44, 0.11), trousers, (0.0, -0.88, 0.10), 0.5),
            limb((0.08, 0.34, 0.08), coat, (0.0, -1.42, -0.24), 0.5),
            limb((0.08, 0.34, 0.08), coat, (0.0, -1.42, 0.24), 0.0),
        ),
        position=moving_from(at, velocity),
    )


def room(depth: float, half_width: float, seed: int) -> tuple[Part, ...]:
    """Return floor, back wall and two side walls; the camera is inside and looks along z."""
    floor = texture("timber", seed, 0.016, "planks")
    wall, side = texture("brick", seed + 1, 0.016, "tiles"), texture("plaster", seed + 2, 0.016)
    return (ground(floor), _wall(depth, wall), *_sides(half_width, side))


def yard(depth: float, seed: int, *, yaw: float = 0.0) -> tuple[Part, ...]:
    """Return ground and one high wall ``depth`` metres away, slanted by ``yaw``."""
    return (ground(texture("grass", seed, 0.016)), _wall(depth, texture("slate", seed + 1, 0.024, "tiles"), yaw))


def street(depth: float, half_width: float, seed: int) -> tuple[Part, ...]:
    """Return a road between two rows of fronts, closed by a wall ``depth`` metres away."""
    fronts, end = texture("sand", seed + 2, 0.02, "tiles"), texture("slate", seed + 1, 0.06)
    return (ground(texture("asphalt", seed, 0.016)), _wall(depth, end), *_sides(half_width, fronts))


def ground(surface: Texture) -> Part:
    """Return the plane y = 0."""
    return Part(shape=Plane(), texture=surface, angles=Path(start=(90.0, 0.0, 0.0)))


def _wall(depth: float, surface: Texture, yaw: float = 0.0) -> Part:
    position, angles = Path(start=(0.0, 0.0, depth)), Path(start=(0.0, yaw, 0.0))
    return Part(shape=Plane(), texture=surface, position=position, angles=angles)


def _sides(half_width: float, surface: Texture) -> tuple[Part, Part]:
    """Return walls along z to the left and to the right of the camera."""
    turned = Path(start=(0.0, 90.0, 0.0))
    left, right = (Path(start=(sign * half_width, 0.0, 0.0)) for sign in (-1.0, 1.0))
    return (
        Part(shape=Plane(), texture=surface, position=left, angles=turned),
        Part(shape=Plane(), texture=surface, position=right, angles=turned),
    )
