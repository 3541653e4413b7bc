"""Accumulation of saliency along the flow, in a pass from the past and one from the future, section by section.

A pass continues from the section before, so that no frame is computed twice and the cuts leave no seam.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import AccumulationParams, ForegroundParams, MotionNetworkParams
from moseg.workflows.stages.consistency import CONSISTENCY_PARAMS
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.motion_network import uses_motion_network
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

EVIDENCE_PARAMS = frozenset({"threshold", "sharpness"})
"""Parameters of the foreground that convert saliency into a probability of motion."""
PASSES = ("past", "future")
"""Names of the passes, in the order of the flows' directions: to the previous and to the next frame."""
CARRIED = "carried"
"""Array with the last result of a pass, not rounded as the others are: where a video is cut leaves no trace."""
STRICT, SALIENT, CONSISTENT = range(3)
"""Channels of the maps: strict saliency, saliency, consistency."""


def memory_over(memory: float, gap: int) -> float:
    """Return the share of a memory that is left after a frame, if `gap` frames move as far as one usually does.

    Rounded, so that it is the same on every machine.
    """
    return memory if gap == 1 else round(memory ** (1 / gap), 6)


def mean_of_passes(
    inputs: Inputs, role: str, name: str, channels: Sequence[int] = (), order: slice = slice(None)
) -> Iterator[np.ndarray | tuple[np.ndarray, ...]]:
    """Yield the mean float32 (y, x) of an array over both passes, frame by frame in an `order`.

    With `channels` it is a tuple with the mean of each of these channels.
    """
    from moseg.tasks.half_floats import to_float32

    past, future = (inputs[f"{role}_{each}"].array(name)[order] for each in PASSES)

    def mean(before, after):
        return (to_float32(before) + to_float32(after)) / 2

    for before, after in zip(past, future, strict=True):
        if channels:
            yield tuple(mean(before[..., channel], after[..., channel]) for channel in channels)
        else:
            yield mean(before, after)


def _run(params, inputs, rng):
    from moseg.tasks.half_floats import to_float32
    from moseg.tasks.motion_network import join_evidence
    from moseg.tasks.saliency import accumulate, memory_weight

    accumulation_params = AccumulationParams.of_recipe(params["accumulation"])
    direction, order = pass_direction(params["from"])
    frames = inputs.all("saliency")[order]
    looks = list(_looks(params, inputs, len(frames)))[order]
    consistency = inputs["consistency"].array("consistency")[order]

    def see(frame, look, agreement):
        saliencies = [to_float32(frame.array(name)) for name in ("strict_saliency", "saliency")]
        if look:
            logit = _logit_of(frame, look)
            evidence = MotionNetworkParams.of_recipe(params["motion_network"]), _foreground(params)
            saliencies = [join_evidence(saliency, logit, *evidence) for saliency in saliencies]
        return np.dstack([*saliencies, to_float32(agreement[direction])])

    def weigh(agreement):
        weight = memory_weight(to_float32(agreement), direction, accumulation_params)
        return np.dstack([weight, weight, np.full_like(weight, accumulation_params.memory)])

    # Frame by frame: all frames of a section at once would set the peak memory of the run.
    accumulated = accumulate(
        (see(*each) for each in zip(frames, looks, consistency, strict=True)),
        pass_flows(frames, direction),
        (weigh(agreement) for agreement in consistency),
        carried_row(inputs),
    )
    return Output({"maps": np.ascontiguousarray(accumulated[order]), CARRIED: accumulated[-1]})


def _looks(params, inputs: Inputs, num_frames: int):
    """Yield, for each frame of the section, the artifacts of the network's logits that it takes, by direction.

    The direction of a frame's own logit is None; without a network there is none.
    """
    networks = inputs.all("network") if "network" in inputs else []
    looked_at = params.get("looked_at", range(len(networks)))
    by_frame = dict(zip(looked_at, networks, strict=True))
    for frame in range(num_frames):
        if frame in by_frame:
            yield {None: by_frame[frame]}
        else:
            beside = enumerate((frame - 1, frame + 1))
            yield {direction: by_frame[other] for direction, other in beside if other in by_frame}


def _logit_of(frame, look) -> np.ndarray:
    """Return the network's logit for a frame, float32 on the network's grid: its own or what others carry to it."""
    from moseg.tasks.half_floats import to_float32
    from moseg.tasks.motion_network import carry_logits

    logits = [to_float32(network.array("logit")) for network in look.values()]
    if None in look:
        return logits[0]
    flows = frame.array("flows")
    return carry_logits(logits, [to_float32(flows[direction]) for direction in look])


def pass_direction(origin: str) -> tuple[int, slice]:
    """Return the index of the flow to a pass's preceding frame, and the order in which the pass visits the frames."""
    return PASSES.index(origin), slice(None) if origin == "past" else slice(None, None, -1)


def pass_flows(frames, direction: int):
    """Yield the flow float32 (y, x, uv) of each frame in the direction of a pass."""
    from moseg.tasks.half_floats import to_float32

    return (to_float32(frame.array("flows")[direction]) for frame in frames)


def carried_row(inputs: Inputs) -> np.ndarray | None:
    """Return what a pass continues with from the section before; None in its first section."""
    return inputs["carried"].array(CARRIED) if "carried" in inputs else None


def _params(config: PipelineConfig, origin: str, gap: int, looked_at: list[int]) -> dict:
    read = config.accumulation.model_dump(mode="json", exclude=CONSISTENCY_PARAMS)
    read["memory"] = memory_over(read["memory"], gap)
    if not uses_motion_network(config):
        return {"from": origin, "accumulation": read}
    # Without a step each frame has a logit of its own, in the order of the frames.
    carried = {} if config.motion_network.step == 1 else {"looked_at": looked_at}
    return {
        "from": origin,
        "accumulation": read,
        **carried,
        "motion_network": config.motion_network.model_dump(mode="json", exclude={"use", "weights", "step"}),
        "foreground": config.foreground.model_dump(mode="json", include=EVIDENCE_PARAMS),
    }


def _foreground(params) -> ForegroundParams:
    return ForegroundParams.of_recipe(params["foreground"])


ALONG_FLOW = Task("accumulation", "along-flow", version=3, run=_run, params=_params, is_cue=True)

STAGE = Stage(
    name="accumulation",
    about="saliency accumulated along the flow through a section",
    inputs={
        "saliency": "saliency of the section's frames",
        "network": "logits of the motion network for the frames that it looks at, unless it is not used",
        "consistency": "of their flows",
        "carried": "the same pass in the section before",
    },
    arrays={
        "maps": layout("float16", "frame y x map", "0..1: strict saliency, saliency, consistency", step=1 / 256),
        CARRIED: layout("float16", "y x map", "the maps of the pass's last frame"),
    },
    tasks=(ALONG_FLOW,),
)
