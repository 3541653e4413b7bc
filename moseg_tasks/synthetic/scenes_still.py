"""Static scenes with strong parallax, of which every pixel that is labelled as moving is wrong."""

from moseg.tasks.synthetic.paths import Path, Sway
from moseg.tasks.synthetic.props import GroundVector, bush, car, crate, room, texture, yard
from moseg.tasks.synthetic.scene import CameraPath, Part, Scene, Thing
from moseg.tasks.synthetic.shapes import Billboard, Box, Plane
from moseg.tasks.synthetic.texture import Texture

_PALE_SKY = Texture(palette=((232, 240, 250), (250, 252, 255), (255, 255, 255)), texel=0.9, contrast=0.0, seed=2900)


def _open_ground(surface: Texture, sky: Texture = _PALE_SKY, depth: float = 250.0) -> tuple[Part, ...]:
    """Return ground under an open sky, which is a wall without detail ``depth`` metres away."""
    return (
        Part(shape=Plane(), texture=surface, angles=Path(start=(90.0, 0.0, 0.0))),
        Part(shape=Plane(), texture=sky, position=Path(start=(0.0, 0.0, depth))),
    )


def _post(at: GroundVector, seed: int, *, height: float = 2.6, half_width: float = 0.05) -> Thing:
    """Return a thin post that stands on the ground."""
    return crate(at, (half_width, height / 2, half_width), texture("slate", seed, 0.006), yaw=15.0)


def _tree(at: GroundVector, seed: int, *, height: float = 3.2) -> Thing:
    """Return a tree: a trunk and a crown with an irregular outline."""
    trunk, crown = texture("timber", seed, 0.008), texture("moss", seed + 1, 0.014)
    half = 0.3 * height
    return Thing(
        parts=(
            Part(shape=Box(size=(0.09, half, 0.09)), texture=trunk, offset=(0.0, -half, 0.0)),
            Part(
                shape=Billboard(size=(0.8 * half, half), ripples=(0.1, 0.14, 0.09)),
                texture=crown,
                offset=(0.0, -2.7 * half, 0.0),
            ),
        ),
        position=Path(start=(at[0], 0.0, at[1])),
    )


def _hedge(at: GroundVector, half_width: float, seed: int) -> Thing:
    """Return a hedge higher than a person; it hides the horizon, where textures of the ground would alias."""
    return crate(at, (half_width, 1.3, 0.6), texture("moss", seed, 0.05), yaw=0.0)


STREET = Scene(
    description="Forward drive along a street of parked cars, boxes, poles and trees.",
    num_motions=1,
    backdrop=_open_ground(texture("asphalt", 2000, 0.016)),
    things=(
        car((2.4, 9.0), texture("scarlet", 2010), texture("slate", 2011)),
        car((2.4, 14.5), texture("indigo", 2012), texture("slate", 2013)),
        car((-2.7, 17.0), texture("plaster", 2014), texture("slate", 2015), yaw=180.0),
        crate((-2.6, 8.5), (0.4, 0.5, 0.5), texture("straw", 2016), yaw=10.0),
        crate((-3.4, 11.5), (0.5, 0.8, 0.7), texture("teal", 2017, pattern="tiles"), yaw=-15.0),
        _post((-2.0, 10.2), 2020),
        _post((1.9, 12.0), 2021),
        _post((-2.0, 14.4), 2022),
        _tree((4.6, 12.2), 2030),
        _tree((-4.6, 14.0), 2032, height=4.0),
        _tree((4.8, 18.5), 2034, height=4.2),
        crate((-9.0, 22.0), (3.0, 2.4, 6.0), texture("brick", 2040, 0.02, "tiles"), yaw=0.0),
        crate((9.5, 24.0), (3.0, 2.8, 7.0), texture("sand", 2041, 0.02, "tiles"), yaw=0.0),
        _hedge((0.0, 33.0), 16.0, 2042),
    ),
    camera=CameraPath(
        position=Path(
            start=(0.0, -1.5, 0.0), velocity=(0.0, 0.0, 0.24), sways=(Sway(amplitude=(0.0, 0.012, 0.0), period=6.0),)
        ),
        angles=Path(start=(-4.0, 0.0, 0.0), sways=(Sway(amplitude=(0.12, 0.1, 0.0), period=7.0),)),
    ),
)

GARDEN = Scene(
    description="A sideways camera passes a garden behind near stems.",
    num_motions=1,
    backdrop=yard(12.0, 2100, yaw=-8.0),
    things=(
        _post((-0.9, 2.1), 2110, height=2.4, half_width=0.02),
        _post((-0.1, 1.8), 2111, height=2.0, half_width=0.015),
        _post((0.55, 2.3), 2112, height=2.6, half_width=0.025),
        _post((1.3, 1.9), 2113, height=2.2, half_width=0.02),
        bush((-1.8, 4.2), (0.6, 0.6), texture("moss", 2120, 0.008)),
        bush((1.0, 5.0), (0.7, 0.7), texture("coral", 2121, 0.008)),
        bush((2.9, 6.5), (0.9, 0.8), texture("moss", 2122)),
        _tree((-0.4, 7.5), 2130),
        crate((3.6, 9.0), (0.9, 1.0, 0.6), texture("timber", 2140, 0.014, "planks"), yaw=20.0),
    ),
    camera=CameraPath(
        position=Path(start=(-0.5, -1.3, 0.0), velocity=(0.04, 0.0, 0.0)), angles=Path(start=(-4.0, 0.0, 0.0))
    ),
)

WALL = Scene(
    description="A walk along a wall that fills half of the frame, so that depth is a steep ramp.",
    num_motions=1,
    backdrop=(
        *_open_ground(texture("sand", 2200, 0.014)),
        Part(
            shape=Plane(),
            texture=texture("brick", 2201, 0.012, "tiles"),
            position=Path(start=(1.9, 0.0, 0.0)),
            angles=Path(start=(0.0, 90.0, 0.0)),
        ),
    ),
    things=(
        crate((1.6, 4.6), (0.22, 0.4, 0.22), texture("teal", 2210, 0.008), yaw=12.0),
        _post((0.9, 6.5), 2211, height=3.0, half_width=0.05),
        bush((-1.6, 7.5), (0.8, 0.8), texture("moss", 2212)),
        crate((-3.5, 10.0), (0.8, 1.2, 0.8), texture("straw", 2213, 0.014, "tiles"), yaw=-25.0),
        _tree((-2.6, 13.0), 2214, height=4.0),
        _hedge((-8.0, 22.0), 9.5, 2216),
    ),
    camera=CameraPath(
        position=Path(
            start=(0.3, -1.6, 0.0),
            velocity=(0.0, 0.0, 0.06),
            sways=(Sway(amplitude=(0.015, 0.03, 0.0), period=12.0),),
        ),
        angles=Path(start=(-3.0, 14.0, 0.0), sways=(Sway(amplitude=(0.2, 0.3, 0.25), period=11.0),)),
    ),
)

ORBIT = Scene(
    description="A hand-held camera turns about a group of boxes while it looks at it.",
    num_motions=1,
    backdrop=room(11.0, 6.0, 2300),
    things=(
        crate((0.0, 4.4), (0.35, 0.7, 0.35), texture("violet", 2310, 0.008), yaw=35.0),
        crate((-0.8, 5.2), (0.3, 0.35, 0.3), texture("straw", 2311, 0.008, "tiles"), yaw=10.0),
        crate((0.9, 5.6), (0.4, 0.5, 0.3), texture("coral", 2312, 0.008), yaw=-20.0),
        bush((2.6, 7.6), (0.8, 1.0), texture("moss", 2313)),
        bush((-2.8, 8.2), (0.9, 1.1), texture("moss", 2314)),
    ),
    camera=CameraPath(
        position=Path(
            start=(-0.75, -1.6, 0.0),
            velocity=(0.065, 0.0, 0.0),
            sways=(Sway(amplitude=(0.015, 0.02, 0.012), period=5.3, phase=0.2),),
        ),
        angles=Path(
            start=(-9.0, 9.0, 0.0),
            velocity=(0.0, -0.8, 0.0),
            sways=(Sway(amplitude=(0.35, 0.25, 0.4), period=6.1, phase=0.4),),
        ),
    ),
)

BRIGHT_SKY = Scene(
    description="A walk in bright light: half of each frame is a sky without detail, and pale surfaces are saturated.",
    num_motions=1,
    backdrop=_open_ground(
        Texture(palette=((196, 190, 176), (214, 208, 196), (186, 180, 166)), texel=0.016, contrast=0.05, seed=2400)
    ),
    things=(
        crate((-2.6, 9.0), (0.9, 1.1, 0.9), texture("plaster", 2410, 0.014, "tiles"), yaw=25.0),
        crate((2.9, 12.0), (1.4, 1.6, 1.2), texture("plaster", 2411, 0.016), yaw=-20.0),
        _post((-0.9, 6.0), 2412, height=4.0, half_width=0.05),
        _post((1.3, 7.5), 2413, height=4.4, half_width=0.06),
        _tree((0.3, 15.0), 2414, height=5.0),
        bush((3.4, 7.5), (0.7, 0.6), texture("straw", 2416)),
    ),
    camera=CameraPath(
        position=Path(start=(-0.3, -1.6, 0.0), velocity=(0.03, 0.0, 0.05)),
        angles=Path(start=(4.0, -2.0, 0.0), velocity=(0.0, 0.12, 0.0)),
    ),
    gain=Path(start=(1.22, 1.22, 1.2)),
)

ROOFS = Scene(
    description="A flight over blocks of different heights, seen from above: parallax at every roof's edge.",
    num_motions=1,
    backdrop=_open_ground(texture("grass", 2500, 0.05), depth=400.0),
    things=tuple(
        crate((x, z), (half, height, half), texture(palette, 2510 + number, 0.03, "tiles"), yaw=yaw)
        for number, (x, z, half, height, palette, yaw) in enumerate(
            (
                (-5.0, 14.0, 1.6, 1.2, "brick", 10.0),
                (1.0, 16.0, 1.4, 2.6, "sand", 40.0),
                (6.5, 18.0, 1.8, 1.6, "slate", -15.0),
                (-8.5, 21.0, 2.0, 2.4, "plaster", 25.0),
                (-1.8, 24.0, 1.8, 1.5, "coral", -30.0),
                (5.0, 27.0, 2.0, 3.0, "straw", 5.0),
                (12.0, 28.0, 2.2, 1.8, "brick", 30.0),
                (-12.0, 31.0, 2.4, 2.0, "teal", -10.0),
            )
        )
    ),
    camera=CameraPath(
        position=Path(start=(-1.0, -11.0, 0.0), velocity=(0.12, 0.0, 0.16)),
        angles=Path(start=(-28.0, 0.0, 0.0), sways=(Sway(amplitude=(0.1, 0.15, 0.2), period=9.0),)),
    ),
)

STILL_SCENES: dict[str, Scene] = {
    "rendered-bright-sky": BRIGHT_SKY,
    "rendered-garden": GARDEN,
    "rendered-orbit": ORBIT,
    "rendered-roofs": ROOFS,
    "rendered-street": STREET,
    "rendered-wall": WALL,
}
"""The rendered sequences of the ``still`` data set, by name."""
