"""Motion saliency of a frame from the flows to its neighbours."""

from moseg_tasks.flow.fill_unknown import fill_unknown
from moseg_tasks.saliency import estimate_saliency
from schemas.parameters import SaliencyParams
from workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    def image(role):
        return inputs[role].cached("image") if role in inputs else None

    def flow(role):
        # Given flow has gaps where its files know none; every pixel of a map needs some.
        return fill_unknown(inputs[role].array("flow")) if role in inputs else None

    result = estimate_saliency(
        image("frame"),
        image("previous"),
        image("next"),
        flow("flow_previous"),
        flow("flow_next"),
        SaliencyParams(**params),
    )
    return Output({"saliency": result.saliency, "flows": result.flows})


BACKGROUND_RESIDUAL = Task("saliency", "background-residual", version=1, run=_run)
