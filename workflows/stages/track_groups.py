"""Track groups: motion groups of balanced samples of a window's dense tracks."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import TrackGroupParams
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.moving_tracks import tracks_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task
from moseg.workflows.stages.trajectory_clustering import read_params


def _run(params, inputs, rng):
    from moseg.tasks.track_objects import group_tracks

    moving = inputs["moving_tracks"]
    group_params = TrackGroupParams.of_recipe(params)
    evidence = (*tracks_of(inputs), moving.array("state"), moving.array("candidate"))
    samples = [group_tracks(*evidence, group_params, rng) for _ in range(group_params.num_samples)]
    arrays = {name: np.concatenate([getattr(each, name) for each in samples]) for name in samples[0]._fields}
    sample = np.repeat(np.arange(len(samples)), [len(each.track) for each in samples])
    return Output({"sample": sample.astype(np.uint16), **arrays})


def samples_of(inputs: Inputs) -> list:
    """Return the `TrackGroups` of each sample of a window's tracks; none if there were too few tracks."""
    from moseg.tasks.track_objects import TrackGroups

    view = inputs["track_groups"]
    sample = view.array("sample")
    arrays = [view.array(name) for name in TrackGroups._fields]
    return [TrackGroups(*(array[sample == number] for array in arrays)) for number in np.unique(sample)]


def _params(config: PipelineConfig) -> dict:
    params = config.track_groups
    # All sampled tracks are clustered, without landmarks and outliers.
    read = params.model_dump(mode="json", exclude={"kernel": {"max_tracks"}})
    read["clustering"] = read_params(params.clustering, params.clustering.method, is_auto=True)
    read["clustering"].pop("outliers", None)
    return read


MOTION_GROUPS = Task("track_groups", "motion-groups", version=6, run=_run, params=_params)

STAGE = Stage(
    name="track_groups",
    about="motion groups of samples of a window's dense tracks",
    inputs={"dense_tracks": "tracks of the window", "moving_tracks": "which of them are candidates for movers"},
    arrays={
        "sample": layout("uint16", "entry", "sample, from 0"),
        "track": layout("int32", "entry", "sampled track"),
        "is_candidate": layout("bool", "entry", "whether it belongs to a candidate; else it is static"),
        "motion": layout("uint16", "entry", "motion group of the sample"),
    },
    tasks=(MOTION_GROUPS,),
)
