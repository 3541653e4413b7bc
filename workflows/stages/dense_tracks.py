"""Dense tracks: points of the whole frame, followed through a window of frames."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import DenseTrackParams
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.workflows.stages.flow import read_flow
from moseg.workflows.stages.picture import bars_of, bars_params
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.dense_tracks import join_runs, track_densely
    from moseg.tasks.flow.fill_unknown import fill_unknown
    from moseg.tasks.screen_graphics import end_hidden, graphics_mask

    images, forward, backward = (inputs.all(role) for role in ("frames", "flow_forward", "flow_backward"))
    dense_params = DenseTrackParams.of_recipe({name: params[name] for name in params if name not in PLACE_PARAMS})
    num_frames = len(images)
    bars = bars_of(params)
    shape = images[0].shape("image")[:2]
    picture = bars.picture(shape)
    runs = params.get("runs", {"step": num_frames, "reach": num_frames})
    starts = range(0, num_frames, runs["step"])

    def track(start):
        run = slice(start, start + runs["reach"] + 1)
        frames = (frame.cached("image")[picture] for frame in images[run])
        to_next, to_previous = (flow[run][: len(images[run]) - 1] for flow in (forward, backward))
        flows = (
            tuple(np.ascontiguousarray(fill_unknown(read_flow(flow))[picture]) for flow in pair)
            for pair in zip(to_next, to_previous, strict=True)
        )
        return track_densely(frames, flows, dense_params)

    tracks = join_runs([track(start) for start in starts], starts, num_frames)
    tracks.points[tracks.visible] += np.float32(bars.corner)
    points, visible = tracks
    if "graphics" in params:
        points, visible = end_hidden(points, visible, graphics_mask(ScreenGraphics(**params["graphics"]), shape))
    return Output({"points": points, "visible": visible})


def _params(
    config: PipelineConfig,
    step: int = 1,
    gap: int = 1,
    bars: BlackBars | None = None,
    graphics: ScreenGraphics | None = None,
) -> dict:
    """Return the parameters of tracks of the scene alone: what hides it is filled, with corners that stand still."""
    params = config.dense_tracks.model_dump(mode="json") | bars_params(bars)
    if graphics is not None:
        params["graphics"] = graphics.as_json()
    # A run is no shorter than the pairs that choose the focal length, nor than the shortest track that is kept.
    reach = max(*config.rigidity.gaps, config.rigidity.focal_gap) * gap
    reach = max(reach, config.dense_tracks.min_frames - 1)
    # Of pairs that are farther apart than they reach, the frames between are not tracked.
    return params if step <= reach else {**params, "runs": {"step": step, "reach": reach}}


LUCAS_KANADE = Task("dense_tracks", "lucas-kanade", version=2, run=_run, params=_params)

PLACE_PARAMS = frozenset({"runs", "bars", "graphics"})
"""Parameters of the recipe that depend on the frames."""

STAGE = Stage(
    name="dense_tracks",
    about="point tracks of the whole frame through a section's window",
    inputs={
        "frames": "frames of the window",
        "flow_forward": "flow from each frame of the window but the last to the next",
        "flow_backward": "flow from each frame of the window but the first to the one before",
    },
    arrays={
        "points": layout("float32", "track frame xy", "px; 0 where not visible"),
        "visible": layout("bool", "track frame"),
    },
    tasks=(LUCAS_KANADE,),
)
