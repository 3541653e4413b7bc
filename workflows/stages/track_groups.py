"""Track groups: motion groups of a balanced sample of a window's dense tracks."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import TrackGroupParams
from moseg.workflows.stages.moving_tracks import tracks_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task
from moseg.workflows.stages.trajectory_clustering import read_params


def _run(params, inputs, rng):
    from moseg.tasks.track_objects import group_tracks

    moving = inputs["moving_tracks"]
    group_params = TrackGroupParams.of_recipe(params)
    return Output(
        group_tracks(*tracks_of(inputs), moving.array("state"), moving.array("candidate"), group_params, rng)._asdict()
    )


def _params(config: PipelineConfig) -> dict:
    params = config.track_groups
    read = params.model_dump(mode="json")
    read["clustering"] = read_params(params.clustering, params.clustering.method, is_auto=True)
    return read


MOTION_GROUPS = Task("track_groups", "motion-groups", version=5, run=_run, params=_params)

STAGE = Stage(
    name="track_groups",
    about="motion groups of a sample of a window's dense tracks",
    inputs={"dense_tracks": "tracks of the window", "moving_tracks": "which of them are candidates for movers"},
    arrays={
        "track": layout("int32", "sample", "sampled track"),
        "is_candidate": layout("bool", "sample", "whether it belongs to a candidate; else it is static"),
        "motion": layout("uint16", "sample", "motion group"),
    },
    tasks=(MOTION_GROUPS,),
)
