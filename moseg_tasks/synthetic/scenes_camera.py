"""Scenes whose difficulty lies in the camera: how it moves, zooms and exposes."""

from moseg.tasks.synthetic.paths import Path, Sway
from moseg.tasks.synthetic.props import ball, bush, car, crate, room, street, texture, walker, yard
from moseg.tasks.synthetic.scene import CameraPath, Scene

PAN = Scene(
    description="The camera pans and drifts; a walker crosses against the pan.",
    num_motions=2,
    backdrop=room(12.0, 6.5, 100),
    things=(
        crate((-1.9, 6.2), (0.55, 0.5, 0.5), texture("teal", 110)),
        walker((2.0, 5.6), texture("scarlet", 111, 0.008), texture("indigo", 112, 0.008), velocity=(-0.045, 0.0)),
        bush((1.9, 8.6), (0.8, 0.9), texture("moss", 113)),
        crate((3.6, 7.5), (0.4, 0.8, 0.4), texture("straw", 114, pattern="tiles"), yaw=-35.0),
    ),
    camera=CameraPath(
        position=Path(start=(0.0, -1.4, 0.0), velocity=(0.012, 0.0, 0.0)),
        angles=Path(start=(-3.0, -4.0, 0.0), velocity=(0.0, 0.42, 0.0)),
    ),
)

FORWARD_DRIVE = Scene(
    description="Forward drive behind a car on a parallel course: its points stay on their epipolar lines, so that "
    "trajectories alone cannot tell it from the street.",
    num_motions=2,
    backdrop=street(60.0, 7.0, 200),
    things=(
        crate((-4.4, 13.0), (0.6, 1.1, 0.6), texture("teal", 210, 0.016, "tiles")),
        car((2.3, 9.2), texture("scarlet", 211), texture("slate", 212), velocity=(0.0, 0.2)),
        bush((5.0, 15.0), (1.1, 1.3), texture("moss", 213, 0.016)),
        crate((-2.6, 18.0), (0.8, 1.0, 0.8), texture("straw", 214, 0.02), yaw=-20.0),
    ),
    camera=CameraPath(
        position=Path(start=(0.0, -1.5, 0.0), velocity=(0.0, 0.0, 0.26)), angles=Path(start=(-2.0, 0.0, 0.0))
    ),
)

STRONG_PARALLAX = Scene(
    description="A sideways camera passes static things at very different depths, whose flow differs as much as the "
    "mover's: flow without depth cannot explain them.",
    num_motions=2,
    backdrop=yard(15.0, 300),
    things=(
        crate((-0.9, 3.4), (0.16, 1.4, 0.16), texture("bronze", 310, 0.006), yaw=30.0),
        crate((1.9, 4.8), (0.45, 0.55, 0.45), texture("violet", 311, 0.008)),
        ball((0.5, 7.0), 0.62, texture("coral", 312), height=1.1, velocity=(-0.035, 0.0)),
        bush((3.4, 9.0), (1.0, 1.1), texture("moss", 313)),
        crate((-3.2, 11.0), (0.9, 1.3, 0.6), texture("straw", 314, 0.016, "tiles"), yaw=-15.0),
    ),
    camera=CameraPath(
        position=Path(start=(-0.6, -1.4, 0.0), velocity=(0.06, 0.0, 0.0)), angles=Path(start=(-3.0, 0.0, 0.0))
    ),
)

PURE_ROTATION = Scene(
    description="The camera only turns about its own centre: there is no parallax, and no epipolar geometry.",
    num_motions=2,
    backdrop=room(11.0, 6.0, 400),
    things=(
        bush((-2.2, 7.0), (0.8, 1.0), texture("moss", 410)),
        crate((2.1, 6.4), (0.5, 0.6, 0.5), texture("straw", 411, pattern="tiles"), yaw=35.0),
        car((-0.4, 8.8), texture("indigo", 412), texture("plaster", 413), yaw=90.0, velocity=(0.07, 0.0)),
    ),
    camera=CameraPath(
        position=Path(start=(0.0, -1.6, 0.0)),
        angles=Path(
            start=(-3.0, -3.0, -3.0),
            velocity=(0.0, 0.3, 0.28),
            sways=(Sway(amplitude=(1.6, 0.0, 0.0), period=20.0),),
        ),
    ),
)

ZOOM = Scene(
    description="The focal length grows by half while the camera drifts; a walker crosses.",
    num_motions=2,
    backdrop=yard(13.0, 500, yaw=18.0),
    things=(
        walker((-1.6, 6.6), texture("straw", 510, 0.008), texture("violet", 511, 0.008), velocity=(0.055, 0.0)),
        crate((1.5, 7.4), (0.6, 0.6, 0.5), texture("scarlet", 512), yaw=25.0),
        bush((-1.7, 9.5), (0.9, 1.0), texture("moss", 513)),
    ),
    camera=CameraPath(
        position=Path(start=(0.0, -1.3, 0.0), velocity=(0.015, 0.0, 0.0)),
        angles=Path(start=(-3.0, 0.0, 0.0)),
        focal=0.85,
        zoom=0.021,
    ),
)

STATIC_CAMERA = Scene(
    description="The camera stands still, so the background has no flow at all; a car crosses.",
    num_motions=2,
    backdrop=street(16.0, 8.0, 600),
    things=(
        crate((-2.6, 7.0), (0.5, 0.7, 0.5), texture("violet", 610), yaw=-25.0),
        bush((3.3, 9.5), (0.9, 1.1), texture("moss", 611)),
        car((-1.6, 10.5), texture("teal", 612), texture("plaster", 613), yaw=90.0, velocity=(0.1, 0.0)),
    ),
    camera=CameraPath(position=Path(start=(0.0, -1.6, 0.0)), angles=Path(start=(-3.0, 0.0, 0.0))),
)

HANDHELD_JITTER = Scene(
    description="A hand-held camera shakes in all six degrees of freedom from frame to frame.",
    num_motions=2,
    backdrop=room(11.0, 5.5, 700),
    things=(
        crate((1.7, 5.6), (0.45, 0.6, 0.45), texture("teal", 710, pattern="tiles"), yaw=40.0),
        walker((-1.4, 6.0), texture("indigo", 711, 0.008), texture("bronze", 712, 0.008), velocity=(0.04, -0.01)),
        bush((-2.9, 8.0), (0.8, 1.0), texture("moss", 713)),
    ),
    camera=CameraPath(
        position=Path(
            start=(0.0, -1.5, 0.0),
            velocity=(0.0, 0.0, 0.02),
            sways=(
                Sway(amplitude=(0.05, 0.03, 0.02), period=7.3, phase=0.1),
                Sway(amplitude=(-0.015, 0.02, 0.01), period=3.1, phase=0.4),
            ),
        ),
        angles=Path(
            start=(-3.0, 0.0, 0.0),
            sways=(
                Sway(amplitude=(0.5, 0.8, 0.6), period=9.7, phase=0.2),
                Sway(amplitude=(-0.2, 0.18, 0.25), period=2.9, phase=0.7),
            ),
        ),
    ),
)

BRIGHTNESS_CHANGE = Scene(
    description="Exposure and white balance flicker over the whole frame while the camera moves.",
    num_motions=2,
    backdrop=yard(12.0, 800, yaw=-15.0),
    things=(
        ball((1.0, 6.0), 0.55, texture("scarlet", 810), height=0.9, velocity=(-0.045, 0.0), bounce=0.25),
        crate((-1.8, 6.5), (0.5, 0.6, 0.5), texture("straw", 811), yaw=30.0),
        bush((2.6, 8.0), (0.8, 0.9), texture("moss", 812)),
    ),
    camera=CameraPath(
        position=Path(start=(0.0, -1.4, 0.0), velocity=(0.035, 0.0, 0.02)), angles=Path(start=(-3.0, 0.0, 0.0))
    ),
    gain=Path(
        start=(0.95, 0.95, 0.95),
        sways=(
            Sway(amplitude=(0.12, 0.12, 0.12), period=5.3),
            Sway(amplitude=(0.04, 0.0, -0.04), period=3.7, phase=0.3),
        ),
    ),
    bias=Path(sways=(Sway(amplitude=(6.0, 6.0, 8.0), period=4.1, phase=0.6),)),
)

NOTHING_MOVES = Scene(
    description="The camera passes near and far things with strong parallax and nothing moves.",
    num_motions=1,
    backdrop=yard(14.0, 900, yaw=10.0),
    things=(
        crate((1.1, 3.8), (0.18, 1.3, 0.18), texture("bronze", 910, 0.006), yaw=15.0),
        crate((-1.5, 5.4), (0.5, 0.6, 0.5), texture("coral", 911), yaw=30.0),
        ball((0.1, 7.5), 0.6, texture("violet", 912), height=0.6),
        bush((3.2, 8.5), (1.0, 1.1), texture("moss", 913)),
    ),
    camera=CameraPath(
        position=Path(start=(-0.5, -1.4, 0.0), velocity=(0.045, 0.0, 0.03)), angles=Path(start=(-3.0, 0.0, 0.0))
    ),
)
