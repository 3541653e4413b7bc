"""Dense tracks: points of the whole frame, followed through a window of frames."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import DenseTrackParams
from moseg.workflows.stages.flow import read_flow
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.dense_tracks import track_densely
    from moseg.tasks.flow.fill_unknown import fill_unknown

    frames = (frame.cached("image") for frame in inputs.all("frames"))
    forward, backward = (inputs.all(role) for role in ("flow_forward", "flow_backward"))
    flows = (
        (fill_unknown(read_flow(to_next)), fill_unknown(read_flow(to_previous)))
        for to_next, to_previous in zip(forward, backward, strict=True)
    )
    return Output(track_densely(frames, flows, DenseTrackParams.of_recipe(params))._asdict())


def _params(config: PipelineConfig) -> dict:
    return config.dense_tracks.model_dump(mode="json")


LUCAS_KANADE = Task("dense_tracks", "lucas-kanade", version=2, run=_run, params=_params)

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
