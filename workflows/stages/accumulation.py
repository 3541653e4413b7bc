"""Accumulation along the flow: a pass from the past and one from the future, a section at a time.

A pass goes on where it left the section before, so that no frame is computed twice and no cut shows.
"""

import numpy as np

from moseg.schemas.parameters import AccumulationParams
from moseg.tasks.half_floats import to_float16, to_float32
from moseg.tasks.saliency import accumulate, flow_consistency, memory_weight
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.task import Output, Task

PASSES = ("past", "future")
"""In the order of the flows' directions: to the previous and to the next frame."""


def mean_of_passes(inputs: Inputs, role: str, name: str) -> np.ndarray:
    """Mean float32 of an array over both passes."""
    past, future = (inputs[f"{role}_{each}"].array(name) for each in PASSES)
    return np.stack([(to_float32(before) + to_float32(after)) / 2 for before, after in zip(past, future, strict=True)])


def _run_consistency(params, inputs, rng):
    flows = [to_float32(frame.array("flows")) for frame in inputs.all("saliency")]
    consistency = flow_consistency(flows, AccumulationParams.of_recipe(params["accumulation"]))
    return Output({"consistency": to_float16(consistency[params["first"] : params["last"]])})


def _run_saliency(params, inputs, rng):
    accumulation_params = AccumulationParams.of_recipe(params["accumulation"])
    direction, order = _direction(params["from"])
    frames = inputs.all("saliency")[order]
    consistency = inputs["consistency"].array("consistency")[order]

    def see(frame, agreement):
        seen = (frame.array("strict_saliency"), frame.array("saliency"), agreement[direction])
        return to_float32(np.dstack(seen))

    def weigh(agreement):
        weight = memory_weight(to_float32(agreement), direction, accumulation_params)
        return np.dstack([weight, weight, np.full_like(weight, accumulation_params.memory)])

    # A frame at a time: all of a section's at once would be the run's peak of memory.
    accumulated = accumulate(
        (see(*each) for each in zip(frames, consistency, strict=True)),
        _flows(frames, direction),
        (weigh(agreement) for agreement in consistency),
        _carried(inputs, "maps", params["from"]),
    )
    return Output({"maps": np.ascontiguousarray(accumulated[order])})


def _run_misfit(params, inputs, rng):
    direction, order = _direction(params["from"])
    frames, misfits = inputs.all("saliency")[order], inputs["own_motion"].array("misfit")[order]
    accumulated = accumulate(
        (to_float32(misfit) for misfit in misfits),
        _flows(frames, direction),
        [params["memory"]] * len(frames),
        _carried(inputs, "misfit", params["from"]),
    )
    return Output({"misfit": np.ascontiguousarray(accumulated[order])})


def _direction(origin):
    """Index of the flow to the frame before in a pass, and the order in which the pass meets the frames."""
    return PASSES.index(origin), slice(None) if origin == "past" else slice(None, None, -1)


def _flows(frames, direction):
    return (to_float32(frame.array("flows")[direction]) for frame in frames)


def _carried(inputs, name, origin):
    """What the pass brings along from the section before."""
    if "carried" not in inputs:
        return None
    row = inputs["carried"].shape(name)[0] - 1 if origin == "past" else 0
    return inputs["carried"].rows(name, row, row + 1)[0]


FLOW_CONSISTENCY = Task("consistency", "forward-backward", version=1, run=_run_consistency)
ALONG_FLOW = Task("accumulation", "along-flow", version=1, run=_run_saliency)
MISFIT_ALONG_FLOW = Task("coherence", "along-flow", version=1, run=_run_misfit)
