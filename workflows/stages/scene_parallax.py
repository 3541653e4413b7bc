"""Scene parallax: the camera's motion in a stretch of video, the source of proposals that suits it, and its depth."""

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import BY_CAMERA, PipelineConfig
from moseg.schemas.parameters import RigidityParams, SceneParallaxParams
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.workflows.stages.picture import bars_of, bars_params
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

CAMERA_PARAMS = frozenset(
    {"pose_cell", "pose_threshold", "pose_iterations", "pose_inliers", "seed"}
    | {"focals", "focal_prior", "focal_slack", "noise", "noise_share"}
)
"""Parameters of rigidity that it reads: those of the camera's motion."""
PLACE_PARAMS = frozenset({"stretch_length", "num_pairs", "min_pairs", "pair_gap"})
"""Parameters that only choose the frames."""


def _run(params, inputs, rng):
    from moseg.tasks.scene_parallax import choose_source, count_still, follow_corners, measure_pairs
    from moseg.tasks.screen_graphics import graphics_mask, pairs_outside

    parallax_params = SceneParallaxParams.of_recipe(params["scene_parallax"])
    frames = inputs.all("frames")
    frame_shape, bars = frames[0].cached("image").shape[:2], bars_of(params)
    picture, shape = bars.picture(frame_shape), bars.picture_shape(frame_shape)
    runs = ([frame.cached("image")[picture] for frame in frames[first : last + 1]] for first, last in params["pairs"])
    pairs = [follow_corners(run, parallax_params) for run in runs]
    if "graphics" in params:
        hidden = graphics_mask(ScreenGraphics(**params["graphics"]), frame_shape)[picture]
        pairs = [pairs_outside(pair, hidden) for pair in pairs]
    evidence = measure_pairs(pairs, shape, parallax_params, RigidityParams.of_recipe(params["rigidity"]))
    num_still = count_still(pairs, shape, parallax_params)
    return Output({}, choose_source(evidence, len(pairs), num_still, parallax_params)._asdict())


def _params(
    config: PipelineConfig,
    pairs: list[tuple[int, int]],
    bars: BlackBars | None = None,
    graphics: ScreenGraphics | None = None,
) -> dict:
    """Return the parameters of pairs of frames, whose corners are those of the scene where something hides it."""
    return {
        **bars_params(bars),
        **({} if graphics is None else {"graphics": graphics.as_json()}),
        "pairs": [list(pair) for pair in pairs],
        "scene_parallax": config.scene_parallax.model_dump(mode="json", exclude=PLACE_PARAMS),
        "rigidity": config.rigidity.model_dump(mode="json", include=CAMERA_PARAMS),
    }


EPIPOLAR = Task("scene_parallax", "epipolar", version=5, run=_run, params=_params)

STAGE = Stage(
    name="scene_parallax",
    about="the camera's motion in a stretch, the source of its proposals, and whether depth shows",
    inputs={"frames": "frames of the pairs at fixed places of the stretch, and those between them"},
    arrays={},
    tasks=(EPIPOLAR,),
    method=lambda config: "epipolar" if config.proposal_source in BY_CAMERA else None,
)
