"""Rigid support: support of a section's objects for being part of the rigid scene, from the dense tracks."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import RigidityParams, RigidSupportParams, SceneParallaxParams
from moseg.workflows.stages.picture import bars_of, bars_params, tracks_in_picture
from moseg.workflows.stages.rigidity import cameras_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

RIGIDITY_PARAMS = frozenset({"noise", "noise_share", "pose_cell", "pose_threshold", "pose_iterations", "seed"})
"""Parameters of rigidity that it reads: the noise of displacements, and the fit of a plane."""
SCENE_PARAMS = frozenset({"min_tracks", "plane_slack"})
"""Parameters of the scene's parallax that it reads: when tracks show depth."""


def _run_masks(params, inputs, rng):
    from moseg.tasks.rigid_support import measure_objects, support_of_evidence

    identity, num_objects = _identities(params, inputs)
    masks, bars = inputs["proposals"].array("masks"), bars_of(params)
    labels = identity[masks[(slice(None), *bars.picture(masks.shape[1:]))]]
    points, visible = tracks_in_picture(inputs, bars)
    rigidity, start = inputs["rigidity"], params["start"]
    pairs = rigidity.array("pairs")
    in_section = np.flatnonzero(pairs[:, 0] >= start)
    cameras = cameras_of(rigidity, labels.shape[1:])
    support_params = RigidSupportParams.of_recipe(params["rigid_support"])
    evidence = measure_objects(
        labels,
        num_objects,
        points[:, start:],
        visible[:, start:],
        pairs[in_section] - [start, 0],
        [cameras[index] for index in in_section],
        rigidity.array("strict_test")[in_section],
        support_params,
        SceneParallaxParams.of_recipe(params["scene_parallax"]),
        RigidityParams.of_recipe(params["rigidity"]),
    )
    support = support_of_evidence(evidence, support_params, params["sensitivity"], params["min_gain"])
    support[np.setdiff1d(np.arange(num_objects), identity)] = np.nan
    return Output({"support": support}, {name: np.asarray(each).tolist() for name, each in evidence._asdict().items()})


def _run_tracks(params, inputs, rng):
    identity, num_objects = _identities(params, inputs)
    is_moving = inputs["proposals"].attributes["is_moving"]
    support = np.full(num_objects, np.nan)
    support[identity[: len(is_moving) + 1]] = [1.0, *(0.0 if moves else 1.0 for moves in is_moving)]
    return Output({"support": support})


def _identities(params, inputs) -> tuple[np.ndarray, int]:
    """Return the object of the sequence of each object of the section, and the number of those."""
    return inputs["linking"].cached("identity")[params["section"]], inputs["linking"].attributes["num_objects"]


def _mask_params(
    config: PipelineConfig, section: int, start: int, min_gain: float, bars: BlackBars | None = None
) -> dict:
    return {
        **bars_params(bars),
        "section": section,
        "start": start,
        "min_gain": min_gain,
        "sensitivity": config.track_objects.sensitivity,
        "rigid_support": config.rigid_support.model_dump(mode="json", exclude={"use"}),
        "rigidity": config.rigidity.model_dump(mode="json", include=RIGIDITY_PARAMS),
        "scene_parallax": config.scene_parallax.model_dump(mode="json", include=SCENE_PARAMS),
    }


def _track_params(config: PipelineConfig, section: int) -> dict:
    return {"section": section}


BY_MASKS = Task("rigid_support", "masks", version=7, run=_run_masks, params=_mask_params)
BY_TRACKS = Task("rigid_support", "tracks", version=1, run=_run_tracks, params=_track_params)

STAGE = Stage(
    name="rigid_support",
    about="support of a section's objects for being part of the rigid scene",
    inputs={
        "proposals": "objects of the section",
        "linking": "identities of its objects",
        "dense_tracks": "tracks of the section's window (masks)",
        "rigidity": "their deviation from a rigid scene (masks)",
    },
    arrays={"support": layout("float64", "object", "1 = static, 0 = moves, NaN = open or not in the section")},
    tasks=(BY_MASKS, BY_TRACKS),
)
