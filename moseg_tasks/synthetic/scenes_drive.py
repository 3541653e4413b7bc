"""Drives along a street in frames of KITTI's shape and field of view: the road, its traffic and parked cars."""

from moseg.tasks.synthetic.paths import Path, Sway
from moseg.tasks.synthetic.props import texture
from moseg.tasks.synthetic.props_road import cyclist, fronts, pole, road, saloon, tree
from moseg.tasks.synthetic.scene import CameraPath, Scene

WIDE_FRAME = {"height": 188, "width": 622, "num_frames": 16}
"""Half the size of KITTI's frames, px."""


def _driving(speed: float, phase: float) -> CameraPath:
    """Return a camera 1.65 m above the road that advances ``speed`` metres a frame and rocks on its springs."""
    return CameraPath(
        position=Path(
            start=(0.0, -1.65, 0.0),
            velocity=(0.0, 0.0, speed),
            sways=(Sway(amplitude=(0.01, 0.012, 0.0), period=9.0, phase=phase),),
        ),
        angles=Path(
            start=(-1.2, 0.0, 0.0),
            sways=(
                Sway(amplitude=(0.15, 0.0, 0.1), period=7.0, phase=phase),
                Sway(amplitude=(0.0, 0.3, 0.0), period=26.0, phase=phase + 0.2),
            ),
        ),
        focal=0.58,
    )


DRIVE_ONCOMING_CAR = Scene(
    description="Drive along a street while a car comes along its own lane: its points move along their epipolar "
    "lines, like those of something nearer that stands still.",
    num_motions=2,
    backdrop=(
        *road(-5.2, 4.8, 2100, dashes=(-1.7,)),
        *fronts(-5.2, -1, ((-10, 22, 3.5, 7.0, "brick"), (25, 48, 5, 9, "sand"), (50, 90, 3, 6, "plaster")), 2110),
        *fronts(4.8, 1, ((-10, 14, 4.0, 6.0, "plaster"), (16, 36, 3.2, 9, "timber"), (40, 95, 4.5, 8, "slate")), 2120),
        *tree((-6.4, 17.0), 2130),
        *tree((-6.6, 31.0), 2132),
        *tree((6.2, 24.0), 2134),
        *tree((6.4, 44.0), 2136),
        pole((5.5, 13.5), 2138),
        pole((-5.9, 24.0), 2139),
    ),
    things=(
        saloon((3.6, 13.0), "silver", 2140),
        saloon((-3.3, 27.0), "ruby", 2150, heading=180.0, velocity=(0.0, -0.5)),
        saloon((3.7, 20.0), "white", 2160),
        saloon((3.6, 33.0), "navy", 2170),
    ),
    camera=_driving(0.7, 0.1),
    **WIDE_FRAME,
)

DRIVE_OVERTAKING_CAR = Scene(
    description="A car in the next lane overtakes the camera, and another drives ahead in the same lane at almost the "
    "camera's speed.",
    num_motions=3,
    backdrop=(
        *road(-5.4, 2.4, 2200, dashes=(-1.7,)),
        *fronts(-5.4, -1, ((-10, 10, 6, 5, "plaster"), (17, 42, 4, 8, "brick"), (46, 100, 7, 6, "timber")), 2210),
        *fronts(2.4, 1, ((-10, 26, 6, 8, "sand"), (30, 52, 5, 6, "brick"), (60, 100, 8, 7, "plaster")), 2220),
        *tree((-6.9, 14.0), 2230, height=5.6),
        *tree((-7.0, 24.0), 2232),
        *tree((4.2, 11.5), 2234),
        *tree((4.3, 20.0), 2236, height=4.6),
        *tree((4.2, 34.0), 2238),
        pole((3.0, 16.0), 2240),
        pole((3.0, 40.0), 2241),
        pole((-5.9, 19.0), 2242),
    ),
    things=(
        saloon((-3.3, 6.6), "navy", 2250, velocity=(0.0, 0.95)),
        saloon((0.1, 14.0), "white", 2260, velocity=(0.0, 0.62)),
        saloon((5.3, 27.0), "ruby", 2270, heading=70.0),
    ),
    camera=_driving(0.6, 0.4),
    **WIDE_FRAME,
)

DRIVE_CROSSING_CYCLIST = Scene(
    description="Drive towards a cyclist who crosses the street: a small, thin mover with rolling wheels and pedalling "
    "legs.",
    num_motions=2,
    backdrop=(
        *road(-5.2, 4.8, 2300, dashes=(-1.7,)),
        *fronts(-5.2, -1, ((-10, 15, 3, 8, "sand"), (24, 60, 4, 7, "slate"), (60, 100, 3, 9, "brick")), 2310),
        *fronts(4.8, 1, ((-10, 18, 5, 7, "brick"), (26, 50, 3, 6, "plaster"), (52, 95, 4, 9, "sand")), 2320),
        *tree((-6.5, 12.5), 2330),
        *tree((-6.5, 27.0), 2332),
        *tree((6.3, 15.0), 2334),
        *tree((6.3, 30.0), 2336),
        pole((5.4, 21.0), 2338),
        pole((-5.8, 20.0), 2339),
    ),
    things=(
        saloon((3.7, 12.0), "ink", 2340),
        cyclist(
            (2.7, 17.0),
            texture("straw", 2350, 0.008),
            texture("navy", 2351, 0.008),
            texture("ink", 2352, 0.03).model_copy(update={"contrast": 0.06}),
            velocity=(-0.3, 0.0),
        ),
        saloon((3.6, 24.5), "silver", 2360),
        saloon((-4.2, 26.0), "ruby", 2370, heading=180.0),
    ),
    camera=_driving(0.55, 0.7),
    **WIDE_FRAME,
)

DRIVE_PARKED_ROW = Scene(
    description="Drive between two rows of parked cars: strong parallax, and nothing moves.",
    num_motions=1,
    backdrop=(
        *road(-4.6, 4.4, 2400),
        *fronts(-4.6, -1, ((-10, 18, 3, 6, "timber"), (20, 44, 4, 8, "plaster"), (47, 100, 3, 7, "brick")), 2410),
        *fronts(4.4, 1, ((-10, 24, 3.4, 8, "brick"), (27, 55, 3, 7, "sand"), (57, 100, 5, 6, "slate")), 2420),
        *tree((-5.7, 15.5), 2430),
        *tree((-5.8, 33.0), 2432),
        *tree((5.5, 21.5), 2434),
        *tree((5.6, 39.0), 2436),
        pole((5.0, 11.0), 2438),
        pole((-5.2, 24.0), 2439),
    ),
    things=(
        saloon((-3.5, 12.5), "white", 2440, heading=180.0),
        saloon((3.3, 14.0), "navy", 2450),
        saloon((-3.6, 18.5), "ruby", 2460, heading=180.0),
        saloon((3.3, 20.5), "silver", 2470),
        saloon((-3.5, 26.0), "ink", 2480, heading=180.0),
        saloon((3.4, 27.0), "white", 2490),
    ),
    camera=_driving(0.65, 0.0),
    **WIDE_FRAME,
)
