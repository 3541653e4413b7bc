"""Saliency: deviation of a frame's flow from that of the background."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import SaliencyParams
from moseg.workflows.stages.background import SELECTION_PARAMS
from moseg.workflows.stages.reduced_frame import reduced_levels
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.flow.fill_unknown import fill_unknown
    from moseg.tasks.frame_grid import grid_shape
    from moseg.tasks.saliency import BackgroundChoice, estimate_saliency

    saliency = SaliencyParams.of_recipe(params)
    height, width, _ = inputs["frame"].shape("image")
    grid = grid_shape((height, width), saliency.working_side)

    def image(role):
        return reduced_levels(inputs[role], grid) if role in inputs else None

    def flow(role):
        # On the grid of its search: enlarged to the frame, it would only be averaged again.
        return fill_unknown(inputs[role].cached("flow")) if role in inputs else None

    background = (BackgroundChoice(**inputs["background"].attributes),) if "background" in inputs else ()
    result = estimate_saliency(
        image("frame"),
        image("previous"),
        image("next"),
        flow("flow_previous"),
        flow("flow_next"),
        saliency,
        *background,
        size=(height, width),
    )
    arrays = result._asdict()
    first_layers = [motion and motion.to_json() for motion in arrays.pop("first_layers")]
    return Output(arrays, {"first_layers": first_layers})


def _run_repeated(params, inputs, rng):
    arrays = {name: inputs["saliency"].array(name).copy() for name in STAGE.arrays}
    first_layers = list(inputs["saliency"].attributes["first_layers"])
    for direction, side in enumerate(("previous", "next")):
        if params[side]:
            arrays["flows"][direction] = arrays["residual_flows"][direction] = 0
            first_layers[direction] = None
    return Output(arrays, {"first_layers": first_layers})


def _params(config: PipelineConfig) -> dict:
    return config.saliency.model_dump(mode="json", exclude=SELECTION_PARAMS)


def _repeated_params(config: PipelineConfig, previous: bool, next: bool) -> dict:
    """Return the parameters of a frame that the one before it shows too, or the one after it."""
    return {"previous": previous, "next": next}


BACKGROUND_RESIDUAL = Task(
    "saliency", "background-residual", version=8, run=_run, params=_params, is_cheap=True, is_cue=True
)
REPEATED = Task(
    "saliency", "repeated", version=1, run=_run_repeated, params=_repeated_params, is_cheap=True, is_cue=True
)

STAGE = Stage(
    name="saliency",
    about="motion saliency of a frame",
    inputs={
        "frame": "the frame",
        "background": "the background's model, unless layers of motion are asked for",
        "previous": "nearest frame before that shows another picture",
        "flow_previous": "flow to it",
        "next": "nearest frame after that shows another picture",
        "flow_next": "flow to it",
        "saliency": "saliency of a frame, whose flow to its repetitions is set to zero (repeated)",
    },
    arrays={
        "saliency": layout("float16", "y x", "0..1", step=1 / 1024),
        "strict_saliency": layout("float16", "y x", "0..1", step=1 / 1024),
        "flows": layout("float16", "direction y x uv", "px/frame of the working grid", step=1 / 128),
        "residual_flows": layout("float16", "direction y x uv", "px/frame of the working grid", step=1 / 128),
    },
    tasks=(BACKGROUND_RESIDUAL, REPEATED),
)
