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


def _run_steps(params, inputs, rng):
    from moseg.tasks.saliency import share_out

    saliency = inputs["saliency"]
    arrays = {name: saliency.array(name) for name in STAGE.arrays}
    shares = params["previous"], params["next"]
    # Layers of the background are between the frames that were compared.
    layers = zip(saliency.attributes["first_layers"], shares, strict=True)
    first_layers = [layer if share == 1 else None for layer, share in layers]
    moved = {name: share_out(arrays[name], shares, params["given"]) for name in ("flows", "residual_flows")}
    return Output(arrays | moved, {"first_layers": first_layers})


def _params(config: PipelineConfig) -> dict:
    return config.saliency.model_dump(mode="json", exclude=SELECTION_PARAMS)


def _steps_params(config: PipelineConfig, previous: float, next: float, given: list[bool]) -> dict:
    """Return the share of the motion to the compared picture that lies between a frame and the ones right beside it.

    0 if the frame beside it shows the same picture. `given` tells on which sides there is a picture to compare it with.
    """
    return {"previous": previous, "next": next, "given": given}


BACKGROUND_RESIDUAL = Task(
    "saliency", "background-residual", version=9, run=_run, params=_params, is_cheap=True, is_cue=True
)
STEPS = Task("saliency", "steps", version=1, run=_run_steps, params=_steps_params, is_cheap=True, is_cue=True)

STAGE = Stage(
    name="saliency",
    about="motion saliency of a frame",
    inputs={
        "frame": "the frame",
        "background": "the background's model, unless layers of motion are asked for",
        "previous": "frame before, of the picture that it is compared with",
        "flow_previous": "flow to it",
        "next": "frame after, of the picture that it is compared with",
        "flow_next": "flow to it",
        "saliency": "saliency of a frame, whose flow is shared out to the frames right beside it (steps)",
    },
    arrays={
        "saliency": layout("float16", "y x", "0..1", step=1 / 1024),
        "strict_saliency": layout("float16", "y x", "0..1", step=1 / 1024),
        "flows": layout("float16", "direction y x uv", "px of the working grid", step=1 / 128),
        "residual_flows": layout("float16", "direction y x uv", "px of the working grid", step=1 / 128),
    },
    tasks=(BACKGROUND_RESIDUAL, STEPS),
)
