"""Rigidity: deviation of each dense track from a rigid scene, over frame pairs."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import RigidityParams
from moseg.workflows.stages.inputs import ArtifactView
from moseg.workflows.stages.picture import bars_of, bars_params, tracks_in_picture
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

DEPTH_PARAMS = frozenset(name for name in RigidityParams.model_fields if name.startswith("depth_"))
"""Parameters that only a configuration with depth or cameras reads."""
CAMERA_PARAMS = frozenset(name for name in RigidityParams.model_fields if name.startswith("camera_"))
"""Parameters that only a configuration with cameras reads."""
PLACE_PARAMS = frozenset({"step", "bars"})
"""Parameters of the recipe that depend on the frames."""


def _run(params, inputs, rng):
    from moseg.tasks.rigidity import TRACK_EVIDENCE, estimate_rigidity

    frames, bars = inputs.all("frames"), bars_of(params)
    picture = bars.picture(frames[0].shape("image")[:2])
    cameras, depth_of = None, None
    if "cameras" in inputs:
        cameras, depth_of = _given_cameras(inputs["cameras"]), inputs["cameras"].row_reader("inverse_depth")
    elif "depth" in inputs:
        depths = inputs.all("depth")

        def depth_of(frame):
            return depths[frame].cached("inverse_depth")[picture]

    step = params.get("step", 1)
    rigidity = RigidityParams.of_recipe({name: value for name, value in params.items() if name not in PLACE_PARAMS})
    images = (frame.cached("image")[picture] for frame in frames)
    result = estimate_rigidity(images, *tracks_in_picture(inputs, bars), rigidity, depth_of, step, cameras)
    arrays = {name: getattr(result, name) for name in ("pairs", *TRACK_EVIDENCE)}
    return Output(arrays, {"focal": result.focal, "cameras": [_camera(pair) for pair in result.evidence]})


def _given_cameras(view: ArtifactView):
    """Return the `GivenCameras` of an artifact of cameras, with one focal length for the window."""
    from moseg.tasks.rigidity import GivenCameras

    poses = zip(view.array("pairs").tolist(), view.array("pose"), strict=True)
    focal = np.median(np.sqrt(np.prod(view.array("intrinsics")[:, [0, 1], [0, 1]], axis=1)))
    return GivenCameras({tuple(pair): pose for pair, pose in poses}, focal / max(view.shape("inverse_depth")[1:]))


def cameras_of(rigidity: ArtifactView, shape: tuple[int, int]) -> list:
    """Return the camera's motion in each pair of a rigidity artifact, a list of `CameraMotion`.

    `shape` is the (y, x) of the frames, or of the picture inside their black bars.
    """
    from moseg.tasks.geometry.camera_motion import CameraMotion

    attributes = rigidity.attributes
    focal = attributes["focal"] * max(shape)
    return [
        CameraMotion(np.array(pair["rotation"]), np.array(pair["translation"]), focal) for pair in attributes["cameras"]
    ]


def grounds_of(rigidity: ArtifactView) -> list:
    """Return the ground seen in each pair of a rigidity artifact, a list of `Ground`, or None where none was.

    In pixels of the picture inside black bars.
    """
    from moseg.tasks.rigidity.ground import Ground

    grounds = (pair["ground"] for pair in rigidity.attributes["cameras"])
    return [ground and Ground(np.array(ground["slope"]), np.array(ground["epipole"])) for ground in grounds]


def _camera(pair) -> dict:
    """Return the camera's motion in a pair, and the ground that it saw if there was one."""
    ground = pair.ground and {"slope": pair.ground.slope.tolist(), "epipole": pair.ground.epipole.tolist()}
    return {
        "rotation": pair.motion.rotation.tolist(),
        "translation": pair.motion.translation.tolist(),
        "ground": ground,
    }


def _params(config: PipelineConfig, step: int = 1, gap: int = 1, bars: BlackBars | None = None) -> dict:
    has_cameras = config.cameras.method != "tracks"
    unread = set() if has_cameras else CAMERA_PARAMS
    if not has_cameras and config.depth.method == "none":
        unread |= DEPTH_PARAMS
    params = config.rigidity.model_dump(mode="json", exclude=unread) | bars_params(bars)
    for name in ("gaps", "test_still_frames"):
        params[name] = [gap * frames for frames in params[name]]
    params["focal_gap"] *= gap
    params["pose_reach"] *= gap
    return params if step == 1 else {**params, "step": step}


EPIPOLAR = Task("rigidity", "epipolar", version=13, run=_run, params=_params)

STAGE = Stage(
    name="rigidity",
    about="deviation of a window's dense tracks from a rigid scene",
    inputs={
        "dense_tracks": "tracks of the window",
        "frames": "frames of the window",
        "cameras": "cameras of the window's frames, and depth in their unit, if a network gives them",
        "depth": "inverse depth of the window's frames, if there is any, and no cameras",
    },
    arrays={
        "pairs": layout("int32", "pair frame_gap", "first frame of the window, and frames to the second"),
        "error": layout("float16", "pair track", "deviation in standard deviations; NaN where not seen in the pair"),
        "median_error": layout("float16", "pair track", "the same of the median of similar neighbours"),
        "test": layout("float16", "pair track", "how much worse the patch of a rigid position fits, -1..3; 0 untested"),
        "strict_error": layout("float16", "pair track", "the median error that a patch of two surfaces lets stand"),
        "strict_test": layout("float16", "pair track", "the test with a rigid position for each half of the patch"),
    },
    tasks=(EPIPOLAR,),
)
