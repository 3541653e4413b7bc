"""Carried mask: what a user painted, erased or added in one frame, in all frames of a section that it reaches."""

from collections.abc import Iterator

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.corrections import Stroke
from moseg.schemas.parameters import AppearanceParams, CarryingParams, RefinementParams
from moseg.workflows.stages.accumulation import PASSES
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

COLOUR_PARAMS = frozenset(
    {"levels", "chroma_range", "texture_levels", "texture_range", "texture_scale"}
    | {"smoothing", "texture_smoothing", "floor", "doubt", "texture_doubt", "clip"}
)
"""Parameters of appearance that the colours of a mask read."""


def _run_strokes(params, inputs, rng):
    from moseg.tasks.corrections.strokes import draw_strokes

    shape = inputs.all("frames")[params["frame"]].shape("image")[:2]
    strokes = [Stroke.model_validate(stroke) for stroke in params["strokes"]]
    return _carry_both_ways(params, inputs, draw_strokes(strokes, shape, tuple(params["frame_size"])))


def _run_grown(params, inputs, rng):
    return _carry_both_ways(params, inputs, inputs["grown_object"].array("mask"))


def _run_continued(params, inputs, rng):
    from moseg.tasks.corrections.carrying import CarriedMask
    from moseg.tasks.half_floats import to_float32

    before, origin = inputs["carried"], PASSES.index(params["from"])
    # What comes from the past starts at the last frame of the section before.
    share = to_float32(before.array("share")[1 - origin])
    start = CarriedMask(share, before.array("ratio"), before.attributes["area"])
    num_frames = len(inputs.all("frames"))
    order = range(num_frames) if origin == 0 else range(num_frames - 1, -1, -1)
    masks, ends = _blank(inputs, share.shape)
    ends[1 - origin] = _carry(params, inputs, start, order, origin, masks)
    return _output(masks, ends, start)


def _carry_both_ways(params, inputs, mask: np.ndarray) -> Output:
    """Return a mask of one frame in all frames of the section; in its own it is as it was made."""
    from moseg.tasks.corrections.carrying import start_carrying
    from moseg.tasks.frame_grid import reduced_shape

    frames, own = inputs.all("frames"), params["frame"]
    grid = reduced_shape(mask.shape, params["carrying"]["side"])
    start = start_carrying(frames[own].cached("image"), mask, grid, _carrier(params))
    masks, ends = _blank(inputs, grid)
    masks[own] = mask
    for origin, order in enumerate((range(own + 1, len(frames)), range(own - 1, -1, -1))):
        ends[1 - origin] = _carry(params, inputs, start, order, origin, masks)
    return _output(masks, ends, start)


def _carry(params, inputs, start, order: range, origin: int, masks: np.ndarray) -> np.ndarray:
    """Write the masks of frames in the order of a pass, and return the share of the last one, float32 (h, w)."""
    from moseg.tasks.corrections.carrying import carry_mask, outline_mask

    frames, carrier, carried = inputs.all("frames"), _carrier(params), start
    for frame, (flow_back, flow_forth) in zip(order, _flows(inputs, order, origin, start.share.shape), strict=True):
        if carried.is_lost:
            break
        image = frames[frame].cached("image")
        carried = carry_mask(carried, image, flow_back(), flow_forth(), carrier)
        masks[frame] = outline_mask(carried, image, carrier.refinement)
    return carried.share


def _flows(inputs, order: range, origin: int, grid: tuple[int, int]) -> Iterator[tuple]:
    """Yield readers of the flow of each frame to the one before it in a pass, and of the reverse."""
    from moseg.tasks.flow.fill_unknown import fill_unknown
    from moseg.tasks.frame_grid import flow_on_grid

    size = inputs.all("frames")[0].shape("image")[:2]
    forward, backward = inputs.all("flow_forward"), inputs.all("flow_backward")
    # Of the first frame too where the pass comes from another section; then there are as many pairs as frames.
    shift = len(forward) - len(inputs.all("frames"))

    def reader(view):
        return lambda: flow_on_grid(fill_unknown(view.cached("flow")), grid, size)

    for frame in order:
        pair = frame + shift if origin == 0 else frame
        back, forth = (backward, forward) if origin == 0 else (forward, backward)
        yield reader(back[pair]), reader(forth[pair])


def _blank(inputs, grid: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    frames = inputs.all("frames")
    masks = np.zeros((len(frames), *frames[0].shape("image")[:2]), bool)
    return masks, np.zeros((2, *grid), np.float32)


def _output(masks: np.ndarray, ends: np.ndarray, start) -> Output:
    from moseg.tasks.half_floats import to_float16

    return Output({"mask": masks, "share": to_float16(ends), "ratio": start.ratio}, {"area": start.area})


def _carrier(params):
    from moseg.tasks.corrections.carrying import Carrier

    return Carrier(
        CarryingParams.of_recipe(params["carrying"]),
        AppearanceParams.of_recipe(params["appearance"]),
        RefinementParams.of_recipe(params["refinement"]),
    )


def _read(config: PipelineConfig) -> dict:
    return {
        "carrying": config.carrying.model_dump(mode="json", exclude={"reach"}),
        "appearance": config.appearance.model_dump(mode="json", include=COLOUR_PARAMS),
        "refinement": config.refinement.model_dump(mode="json"),
    }


def _stroke_params(
    config: PipelineConfig, frame: int, strokes: tuple[Stroke, ...], frame_size: tuple[int, int]
) -> dict:
    drawn = [stroke.model_dump(mode="json") for stroke in strokes]
    return {"frame": frame, "strokes": drawn, "frame_size": list(frame_size), **_read(config)}


def _grown_params(config: PipelineConfig, frame: int) -> dict:
    return {"frame": frame, **_read(config)}


def _continued_params(config: PipelineConfig, origin: str) -> dict:
    return {"from": origin, **_read(config)}


STROKES = Task("carried_mask", "strokes", version=4, run=_run_strokes, params=_stroke_params)
GROWN = Task("carried_mask", "grown", version=4, run=_run_grown, params=_grown_params)
CONTINUED = Task("carried_mask", "continued", version=4, run=_run_continued, params=_continued_params)

STAGE = Stage(
    name="carried_mask",
    about="a user's mask of one frame, carried along the flow through a section",
    inputs={
        "frames": "frames of the section that the mask reaches",
        "flow_forward": "flow of their pairs, with that to the section before or after it comes from",
        "flow_backward": "the same against the direction of time",
        "grown_object": "the mask (grown)",
        "carried": "the mask in the section that it comes from (continued)",
    },
    arrays={
        "mask": layout("bool", "frame y x"),
        "share": layout("float16", "end y x", "share of a cell in the first and in the last frame", step=1 / 1024),
        "ratio": layout("float32", "bin", "log ratio of the mask's colours to those around it"),
    },
    tasks=(STROKES, GROWN, CONTINUED),
    # The edit chooses, not the configuration.
    method=lambda config: None,
)
