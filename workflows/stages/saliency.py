"""Motion saliency of a frame from the flows to its neighbours, and the background's model that it follows."""

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.flow.fill_unknown import fill_unknown
from moseg.tasks.saliency import BackgroundChoice, choose_background, estimate_saliency, reduce_flow, working_shape
from moseg.workflows.stages.task import Output, Task


def _run_choice(params, inputs, rng):
    saliency_params = SaliencyParams.of_recipe(params)
    # Given flow has gaps where its files know none; every pixel of a map needs some.
    flows = [fill_unknown(pair.array("flow")) for pair in inputs.all("flows")]
    reduced = [reduce_flow(flow, working_shape(flow.shape[:2], saliency_params.working_side)) for flow in flows]
    return Output({}, choose_background(reduced, saliency_params)._asdict())


def _run_saliency(params, inputs, rng):
    def image(role):
        return inputs[role].cached("image") if role in inputs else None

    def flow(role):
        return fill_unknown(inputs[role].array("flow")) if role in inputs else None

    background = (BackgroundChoice(**inputs["background"].attributes),) if "background" in inputs else ()
    result = estimate_saliency(
        image("frame"),
        image("previous"),
        image("next"),
        flow("flow_previous"),
        flow("flow_next"),
        SaliencyParams.of_recipe(params),
        *background,
    )
    return Output(result._asdict())


MODEL_SELECTION = Task("background", "model-selection", version=1, run=_run_choice)
BACKGROUND_RESIDUAL = Task("saliency", "background-residual", version=3, run=_run_saliency, is_brief=True)
