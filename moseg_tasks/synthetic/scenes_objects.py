"""Scenes whose difficulty lies in the objects: how many move, how, when and behind what."""

from moseg.tasks.synthetic.paths import Path, Sway
from moseg.tasks.synthetic.props import ball, bush, car, crate, moving_from, room, street, texture, walker, yard
from moseg.tasks.synthetic.scene import CameraPath, Part, Scene, Thing
from moseg.tasks.synthetic.shapes import Billboard


def _drifting(x: float = 0.02, z: float = 0.0, *, height: float = 1.4) -> CameraPath:
    """Return a camera that looks slightly down and drifts by (x, z) metres per frame."""
    return CameraPath(
        position=Path(start=(0.0, -height, 0.0), velocity=(x, 0.0, z)), angles=Path(start=(-3.0, 0.0, 0.0))
    )


SAME_MOTION_PAIR = Scene(
    description="Two separate crates ride with one velocity: two objects, but two motions in all.",
    num_motions=2,
    backdrop=room(11.0, 5.5, 1000),
    things=(
        crate((-1.4, 5.6), (0.42, 0.5, 0.42), texture("scarlet", 1010), velocity=(0.04, -0.01)),
        bush((-3.0, 8.0), (0.8, 1.0), texture("moss", 1011)),
        crate((0.9, 6.8), (0.5, 0.6, 0.45), texture("indigo", 1012), yaw=-30.0, velocity=(0.04, -0.01)),
        crate((2.8, 7.6), (0.4, 0.9, 0.4), texture("straw", 1013, pattern="tiles"), yaw=10.0),
    ),
    camera=_drifting(-0.03, 0.015),
)

TWO_MOTIONS = Scene(
    description="Two movers with different motions, one across and one towards the camera.",
    num_motions=3,
    backdrop=yard(13.0, 1100, yaw=-12.0),
    things=(
        ball((-1.5, 6.0), 0.55, texture("coral", 1110), height=1.2, velocity=(0.05, 0.0)),
        crate((0.6, 9.2), (0.45, 0.55, 0.45), texture("straw", 1111), yaw=15.0),
        bush((-3.1, 8.5), (0.9, 1.0), texture("moss", 1112)),
        crate((2.0, 8.2), (0.55, 0.6, 0.5), texture("violet", 1113), yaw=-20.0, velocity=(-0.05, -0.09)),
    ),
    camera=_drifting(-0.02),
)

NONRIGID = Scene(
    description="An articulated walker strides across: legs and arms swing against the body.",
    num_motions=2,
    backdrop=room(10.0, 5.5, 1200),
    things=(
        crate((1.9, 6.4), (0.5, 0.6, 0.5), texture("teal", 1210, pattern="tiles"), yaw=30.0),
        walker((-1.2, 4.6), texture("straw", 1211, 0.006), texture("indigo", 1212, 0.006), velocity=(0.04, 0.0)),
        bush((-2.7, 7.4), (0.8, 0.9), texture("moss", 1213)),
    ),
    camera=_drifting(-0.03, 0.015),
)

DEFORMING = Scene(
    description="A fish-like sheet swims along, its whole body bending as a wave runs through it.",
    num_motions=2,
    backdrop=room(10.0, 5.5, 1300),
    things=(
        Thing(
            parts=(
                Part(
                    shape=Billboard(
                        size=(0.42, 0.95),
                        ripples=(0.05, 0.1, 0.03),
                        bend=Path(
                            sways=(
                                Sway(amplitude=(0.25, 0.1, 0.0), period=14.0),
                                Sway(amplitude=(0.0, -0.3, 0.45), period=14.0, phase=0.25),
                            )
                        ),
                    ),
                    texture=texture("coral", 1310, 0.01),
                ),
            ),
            position=moving_from((0.9, 5.6), (-0.05, 0.0), 1.3),
            angles=Path(start=(0.0, 10.0, -70.0)),
        ),
        crate((-1.8, 6.4), (0.5, 0.5, 0.5), texture("indigo", 1311), yaw=25.0),
        crate((2.4, 7.4), (0.4, 0.9, 0.4), texture("straw", 1312, pattern="tiles"), yaw=-30.0),
    ),
    camera=_drifting(0.03, 0.01),
)

SPINNING_OBJECT = Scene(
    description="A crate turns in place: its motion has no translation, and its image hardly travels.",
    num_motions=2,
    backdrop=yard(11.0, 1400, yaw=15.0),
    things=(
        bush((-2.6, 7.0), (0.8, 1.0), texture("moss", 1410)),
        crate((0.3, 5.0), (0.6, 0.6, 0.6), texture("scarlet", 1411), yaw=5.0, spin=4.0),
        crate((2.4, 6.8), (0.45, 0.7, 0.45), texture("teal", 1412), yaw=35.0),
    ),
    camera=_drifting(0.025, 0.01),
)

LATE_ENTRY = Scene(
    description="The only mover enters from the left in the middle of the sequence.",
    num_motions=2,
    backdrop=room(11.0, 5.5, 1500),
    things=(
        crate((1.5, 6.4), (0.5, 0.6, 0.5), texture("straw", 1510), yaw=30.0),
        bush((2.9, 8.4), (0.8, 0.9), texture("moss", 1511)),
        crate((-4.2, 5.6), (0.5, 0.55, 0.5), texture("violet", 1512), yaw=-15.0, velocity=(0.12, 0.0)),
        crate((-0.9, 8.2), (0.4, 0.7, 0.4), texture("coral", 1513, pattern="tiles"), yaw=10.0),
    ),
    camera=_drifting(0.03, 0.01),
)

OCCLUSION = Scene(
    description="A mover passes behind a static pillar, is hidden for some frames, and comes out again.",
    num_motions=2,
    backdrop=yard(12.0, 1600, yaw=12.0),
    things=(
        crate((0.3, 4.6), (0.36, 1.3, 0.3), texture("bronze", 1610, 0.008, "tiles"), yaw=15.0),
        ball((-1.05, 6.8), 0.42, texture("scarlet", 1611, 0.01), height=1.0, velocity=(0.12, 0.0)),
        crate((2.2, 8.0), (0.5, 0.6, 0.5), texture("indigo", 1612), yaw=-30.0),
    ),
    camera=_drifting(0.025),
)

CROSSING_MOVERS = Scene(
    description="Two cars drive past each other: the nearer hides the farther while they cross.",
    num_motions=3,
    backdrop=street(18.0, 9.0, 1700),
    things=(
        car((-1.6, 8.6), texture("straw", 1710), texture("slate", 1711), yaw=90.0, velocity=(0.11, 0.0)),
        bush((-4.0, 10.5), (0.9, 1.1), texture("moss", 1712)),
        car((1.6, 12.2), texture("indigo", 1713), texture("plaster", 1714), yaw=-90.0, velocity=(-0.15, 0.0)),
        crate((3.1, 7.2), (0.4, 0.7, 0.4), texture("coral", 1715), yaw=25.0),
    ),
    camera=_drifting(0.02, 0.03, height=1.7),
)

SMALL_FAST = Scene(
    description="A small ball crosses fast, about a hundredth of the frame, among larger static things.",
    num_motions=2,
    backdrop=room(10.0, 5.5, 1800),
    things=(
        crate((-1.9, 6.0), (0.55, 0.6, 0.5), texture("teal", 1810), yaw=30.0),
        crate((1.6, 7.0), (0.5, 0.8, 0.5), texture("straw", 1811, pattern="tiles"), yaw=-25.0),
        ball((-1.6, 5.2), 0.29, texture("violet", 1812, 0.008), height=1.3, velocity=(0.11, 0.0), bounce=0.1),
        bush((-0.2, 8.2), (0.8, 0.9), texture("moss", 1813)),
    ),
    camera=_drifting(0.03, 0.01),
)

SLOW_MOVER = Scene(
    description="The camera slides by fast while a ball rises, a third of a pixel a frame: too little for the "
    "flow of two frames, enough for trajectories over several.",
    num_motions=2,
    backdrop=room(11.0, 5.5, 2000),
    things=(
        crate((0.1, 7.4), (0.5, 0.6, 0.45), texture("teal", 2010), yaw=25.0),
        ball((1.9, 6.4), 0.5, texture("coral", 2011), height=1.1, climb=0.006),
        bush((3.4, 8.6), (0.8, 0.9), texture("moss", 2012)),
        crate((4.4, 6.8), (0.4, 0.8, 0.4), texture("straw", 2013, pattern="tiles"), yaw=-20.0),
    ),
    camera=_drifting(0.1),
)

PARALLEL_MOVER = Scene(
    description="The camera tracks a car sideways with its own velocity: the mover stands still in the image while "
    "the world slides past.",
    num_motions=2,
    backdrop=street(15.0, 40.0, 1900),
    things=(
        bush((-2.4, 11.0), (1.0, 1.3), texture("moss", 1910)),
        car((0.2, 7.6), texture("coral", 1911), texture("indigo", 1912), yaw=90.0, velocity=(0.075, 0.0)),
        crate((3.2, 10.0), (0.5, 0.9, 0.5), texture("straw", 1913, pattern="tiles"), yaw=30.0),
        crate((4.4, 6.0), (0.2, 1.0, 0.2), texture("violet", 1914), yaw=10.0),
    ),
    camera=_drifting(0.075, height=1.5),
)
