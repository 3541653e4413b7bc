"""The sequences of the ``synthetic`` data set, by name."""

from moseg.tasks.synthetic import scenes_camera, scenes_drive, scenes_objects
from moseg.tasks.synthetic.scene import Scene

SCENES: dict[str, Scene] = {
    "brightness-change": scenes_camera.BRIGHTNESS_CHANGE,
    "crossing-movers": scenes_objects.CROSSING_MOVERS,
    "deforming": scenes_objects.DEFORMING,
    "drive-crossing-cyclist": scenes_drive.DRIVE_CROSSING_CYCLIST,
    "drive-oncoming-car": scenes_drive.DRIVE_ONCOMING_CAR,
    "drive-overtaking-car": scenes_drive.DRIVE_OVERTAKING_CAR,
    "drive-parked-row": scenes_drive.DRIVE_PARKED_ROW,
    "forward-drive-epipolar-car": scenes_camera.FORWARD_DRIVE,
    "handheld-jitter": scenes_camera.HANDHELD_JITTER,
    "late-entry": scenes_objects.LATE_ENTRY,
    "nonrigid": scenes_objects.NONRIGID,
    "nothing-moves": scenes_camera.NOTHING_MOVES,
    "occlusion": scenes_objects.OCCLUSION,
    "pan": scenes_camera.PAN,
    "parallel-mover": scenes_objects.PARALLEL_MOVER,
    "pure-rotation": scenes_camera.PURE_ROTATION,
    "same-motion-pair": scenes_objects.SAME_MOTION_PAIR,
    "slow-mover": scenes_objects.SLOW_MOVER,
    "small-fast": scenes_objects.SMALL_FAST,
    "spinning-object": scenes_objects.SPINNING_OBJECT,
    "static-camera": scenes_camera.STATIC_CAMERA,
    "strong-parallax": scenes_camera.STRONG_PARALLAX,
    "two-motions": scenes_objects.TWO_MOTIONS,
    "zoom": scenes_camera.ZOOM,
}
