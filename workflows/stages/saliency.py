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
    from moseg.tasks.saliency import BackgroundChoice, estimate_saliency, working_shape

    saliency = SaliencyParams.of_recipe(params)
    height, width, _ = inputs["frame"].shape("image")
    grid = working_shape((height, width), saliency.working_side)

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


def _params(config: PipelineConfig) -> dict:
    return config.saliency.model_dump(mode="json", exclude=SELECTION_PARAMS)


BACKGROUND_RESIDUAL = Task(
    "saliency", "background-residual", version=6, run=_run, params=_params, is_cheap=True, is_cue=True
)

STAGE = Stage(
    name="saliency",
    about="motion saliency of a frame",
    inputs={
        "frame": "the frame",
        "background": "the background's model, unless layers of motion are asked for",
        "previous": "frame before",
        "flow_previous": "flow to the frame before",
        "next": "frame after",
        "flow_next": "flow to the frame after",
    },
    arrays={
        "saliency": layout("float16", "y x", "0..1", step=1 / 1024),
        "strict_saliency": layout("float16", "y x", "0..1", step=1 / 1024),
        "flows": layout("float16", "direction y x uv", "px/frame of the working grid", step=1 / 128),
        "residual_flows": layout("float16", "direction y x uv", "px/frame of the working grid", step=1 / 128),
    },
    tasks=(BACKGROUND_RESIDUAL,),
)
