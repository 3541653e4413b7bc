"""Proposals: objects of a section, segmented by motion, tracked from its first frame, or given."""

from collections.abc import Iterator

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import MOTION_SOURCES, TRACKED_SOURCES, PipelineConfig
from moseg.schemas.parameters import (
    DeaotParams,
    EdgeTamParams,
    LocalColourParams,
    RefinementParams,
    Sam2Params,
    Sam3Params,
    TrackMaskParams,
    TrackSurfaceParams,
)
from moseg.workflows.stages.components import join_rows
from moseg.workflows.stages.flow import read_flow
from moseg.workflows.stages.instances import SAM3_DOCUMENTS
from moseg.workflows.stages.moving_tracks import tracks_of
from moseg.workflows.stages.object_points import moving_objects
from moseg.workflows.stages.picture import bars_of, bars_params
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import TRANSFORMERS, Backend, Choice, Stage
from moseg.workflows.stages.task import Network, Output, Task
from moseg.workflows.stages.track_surfaces import MASK_PARAMS

OF_OBJECTS = ("candidates", "is_moving", "identities", "tags")
"""Attributes of proposals that have an entry for each object."""


def _run_saliency(params, inputs, rng):
    from moseg.tasks.half_floats import to_float32
    from moseg.tasks.proposals.boxes import object_boxes
    from moseg.tasks.proposals.refinement import refine_outlines

    refinement = RefinementParams.of_recipe(params["refinement"])
    colours = LocalColourParams.of_recipe(params["local_colours"])
    components, frames = inputs["components"], inputs.all("frames")
    labels, scores = components.array("labels"), components.array("scores")
    foreground = join_rows(inputs.all("foreground"), "foreground", len(labels))
    masks = np.stack(
        [
            refine_outlines(frame.cached("image"), objects, to_float32(probability), refinement, colours)
            for frame, objects, probability in zip(frames, labels, foreground, strict=True)
        ]
    )
    return Output({"masks": masks, "scores": scores, "boxes": object_boxes(masks, len(scores))})


def _run_tracks(params, inputs, rng):
    from moseg.tasks.flow.fill_unknown import fill_unknown
    from moseg.tasks.proposals.boxes import object_boxes
    from moseg.tasks.proposals.surface_masks import surface_masks
    from moseg.tasks.proposals.track_masks import number_seen, track_masks
    from moseg.tasks.track_objects import static_candidates

    (points, visible), found, added = tracks_of(inputs), inputs["track_objects"], inputs["object_points"]
    objects, is_moving = found.array("object"), found.array("is_moving")
    moves = np.concatenate([[False], is_moving])
    frames = (frame.cached("image") for frame in inputs.all("frames"))
    masks = track_masks(
        frames,
        (fill_unknown(flow) for flow in _flows_to_next(inputs)),
        np.concatenate([points, added.array("points")]),
        np.concatenate([visible, added.array("visible")]),
        np.concatenate([moving_objects(inputs), added.array("object")]),
        params["start"],
        TrackMaskParams.of_recipe(params["track_masks"]),
        RefinementParams.of_recipe(params["refinement"]),
        LocalColourParams.of_recipe(params["local_colours"]),
    )
    surface_params = TrackSurfaceParams.of_recipe(params["track_surfaces"])
    labelled = range(params["start"], params["start"] + len(masks))
    # What is seen in other frames of the window alone has no pixels here.
    is_seen = visible[:, labelled].any(axis=1)
    surface = inputs["track_surfaces"].array("surface")
    still = static_candidates(objects * is_seen, is_moving, surface * is_seen, params["max_static"])
    behind = surface_masks(masks.shape[1:], points, visible, still, labelled, surface_params)
    masks, candidates = number_seen(np.where(masks > 0, masks, behind))
    # Surfaces have no score: there is no evidence that they move.
    of_object = np.where(candidates < len(moves), candidates, 0)
    scores = np.concatenate([[0.0], found.array("scores")])[of_object]
    return Output(
        {"masks": masks, "scores": scores, "boxes": object_boxes(masks, len(scores))},
        {"candidates": candidates.tolist(), "is_moving": moves[of_object].tolist()},
    )


def _flows_to_next(inputs) -> Iterator[np.ndarray]:
    """Yield the flow of each frame to the next one; of the last frame, the reverse of the flow to the one before it."""
    for flow in inputs.all("flow_next"):
        yield read_flow(flow)
    yield -read_flow(inputs["flow_previous"])


def _run_given(params, inputs, rng):
    from moseg.tasks.proposals.boxes import object_boxes
    from moseg.tasks.proposals.given import relabel_masks
    from moseg.workflows.sources.resize import resize_labels

    # A frame without a given mask has no object.
    given = np.zeros((params["stop"] - params["start"], *params["shape"]), np.uint16)
    read_mask = inputs["masks"].row_reader("masks")
    for row, frame in enumerate(inputs["masks"].attributes["indices"]):
        if params["start"] <= frame < params["stop"]:
            given[frame - params["start"]] = resize_labels(read_mask(row), tuple(params["shape"]))
    if params["void"] is not None:
        given[given == params["void"]] = 0
    masks, identities = relabel_masks(given)
    boxes = object_boxes(masks, len(identities))
    return Output(
        {"masks": masks, "scores": np.ones(len(identities)), "boxes": boxes},
        {"identities": identities.tolist()},
    )


def _run_deaot(params, inputs, rng):
    from moseg.tasks.networks.deaot import build_deaot
    from moseg.tasks.proposals.deaot import track_masks_deaot

    return _track(build_deaot, track_masks_deaot, DeaotParams.of_recipe(params["deaot"]), inputs)


def _run_sam2(params, inputs, rng):
    from moseg.tasks.networks.sam2 import build_sam2_video
    from moseg.tasks.proposals.sam2 import track_masks_sam2

    return _track(build_sam2_video, track_masks_sam2, Sam2Params.of_recipe(params["sam2"]), inputs)


def _run_edgetam(params, inputs, rng):
    from moseg.tasks.networks.edgetam import build_edgetam_video
    from moseg.tasks.proposals.sam2 import track_masks_sam2

    return _track(build_edgetam_video, track_masks_sam2, EdgeTamParams.of_recipe(params["edgetam"]), inputs)


def _run_sam3(params, inputs, rng):
    from moseg.tasks.networks.sam3 import build_sam3_tracker
    from moseg.tasks.proposals.sam2 import track_masks_sam2

    return _track(build_sam3_tracker, track_masks_sam2, Sam3Params.of_recipe(params["sam3"]), inputs)


def _track(build, track_masks, tracker_params, inputs):
    from moseg.tasks.proposals.boxes import object_boxes

    seeds = inputs["seeds"]
    frames = (frame.cached("image") for frame in inputs.all("frames"))
    identities = seeds.array("identities")
    with open_network(build, inputs["weights"]) as network:
        masks = track_masks(network, frames, seeds.array("labels"), tracker_params)
    return Output(
        {"masks": masks, "scores": seeds.array("scores"), "boxes": object_boxes(masks, len(identities))},
        {
            "identities": identities.tolist(),
            "tags": seeds.attributes["tags"],
            "num_identities": seeds.attributes["num_identities"],
            **made_on(),
        },
    )


def _run_inside(params, inputs, rng):
    from moseg.tasks.black_bars import keep_inside
    from moseg.tasks.proposals.boxes import object_boxes

    scores, attributes = inputs["proposals"].array("scores"), inputs["proposals"].attributes
    masks, kept = keep_inside(inputs["proposals"].array("masks"), len(scores), bars_of(params))
    of_objects = {name: [attributes[name][index] for index in kept] for name in OF_OBJECTS if name in attributes}
    return Output(
        {"masks": masks, "scores": scores[kept], "boxes": object_boxes(masks, len(kept))},
        {**attributes, **of_objects, "kept": (kept + 1).tolist()},
    )


def _saliency_params(config: PipelineConfig) -> dict:
    return {name: getattr(config, name).model_dump(mode="json") for name in ("refinement", "local_colours")}


def _track_params(config: PipelineConfig, start: int, section: int) -> dict:
    """Return the parameters of the masks of a section, of which the later ones have fewer static candidates."""
    surfaces = config.track_surfaces
    return {
        "start": start,
        "max_static": surfaces.max_candidates >> section // surfaces.halved_after,
        "track_masks": config.track_masks.model_dump(mode="json"),
        "refinement": config.refinement.model_dump(mode="json"),
        "local_colours": config.local_colours.model_dump(mode="json"),
        "track_surfaces": surfaces.model_dump(mode="json", include=MASK_PARAMS),
    }


def _given_params(config: PipelineConfig, start: int, stop: int, shape: tuple[int, int], void: int | None) -> dict:
    return {"start": start, "stop": stop, "shape": list(shape), "void": void}


def _inside_params(config: PipelineConfig, bars: BlackBars) -> dict:
    return bars_params(bars)


def _deaot_params(config: PipelineConfig) -> dict:
    return {"deaot": config.deaot.model_dump(mode="json", exclude={"weights"})}


def _sam2_params(config: PipelineConfig) -> dict:
    # The other parameter belongs to the masks of boxes.
    return {"sam2": config.sam2.model_dump(mode="json", exclude={"weights", "boxes_per_pass"})}


def _edgetam_params(config: PipelineConfig) -> dict:
    return {"edgetam": config.edgetam.model_dump(mode="json", exclude={"weights", "boxes_per_pass"})}


def _sam3_params(config: PipelineConfig) -> dict:
    # The others belong to the detector.
    return {"sam3": config.sam3.model_dump(mode="json", include={"objects_per_pass", "memory_reach"})}


def _method(config: PipelineConfig) -> str:
    if config.proposal_source in TRACKED_SOURCES:
        return config.detections.tracker
    if config.proposal_source == "auto":
        # The graph names the method of each section.
        return "saliency"
    return config.proposal_source if config.proposal_source in MOTION_SOURCES else "given"


SALIENCY = Task("proposals", "saliency", version=4, run=_run_saliency, params=_saliency_params)
DENSE_TRACKS = Task("proposals", "tracks", version=6, run=_run_tracks, params=_track_params)
GIVEN_MASKS = Task("proposals", "given", version=1, run=_run_given, params=_given_params)
INSIDE = Task("proposals", "inside", version=1, run=_run_inside, params=_inside_params)
DEAOT = Task(
    "proposals",
    "deaot",
    version=1,
    run=_run_deaot,
    params=_deaot_params,
    network=Network("deaot", "deaot.weights", "deaot-r50-l"),
)
SAM2 = Task(
    "proposals",
    "sam2",
    version=2,
    run=_run_sam2,
    params=_sam2_params,
    network=Network("sam2", "sam2.weights", "sam2.1-hiera-large", ("config.json",)),
)
EDGETAM = Task(
    "proposals",
    "edgetam",
    version=1,
    run=_run_edgetam,
    params=_edgetam_params,
    network=Network("edgetam", "edgetam.weights", "edgetam", ("config.json",)),
)
SAM3 = Task(
    "proposals",
    "sam3",
    version=1,
    run=_run_sam3,
    params=_sam3_params,
    network=Network("sam3", "sam3.weights", "sam3", SAM3_DOCUMENTS),
)

STAGE = Stage(
    name="proposals",
    about="objects of a section",
    inputs={
        "frames": "frames of the section, and those that it shares with the next",
        "components": "objects on the working grid (saliency)",
        "foreground": "probability to move, of every section with a frame of this one (saliency)",
        "dense_tracks": "tracks of the section's window (tracks)",
        "track_objects": "objects of these tracks (tracks)",
        "object_points": "more points of these objects, and of the background beside them (tracks)",
        "track_surfaces": "surfaces of these tracks that stand above the ground (tracks)",
        "flow_next": "flow from each of the frames but the last to the next (tracks)",
        "flow_previous": "flow from the last frame to the one before it (tracks)",
        "seeds": "objects that tracking starts with (trackers)",
        "masks": "given masks of the sequence (given)",
        "proposals": "objects of the section by another method, with what lies in black bars (inside)",
        "weights": "of the network",
    },
    arrays={
        "masks": layout("uint16", "frame y x", "object of the section, 0 = background"),
        "scores": layout("float64", "object"),
        "boxes": layout("int32", "object frame xyxy", "px, -1 where absent"),
    },
    tasks=(SALIENCY, DENSE_TRACKS, GIVEN_MASKS, INSIDE, DEAOT, SAM2, EDGETAM, SAM3),
    method=_method,
    choices=(
        Choice(
            "proposals",
            "proposal_source",
            "--proposals",
            (
                Backend("auto", "saliency or tracks, by the camera's motion in each stretch of the video"),
                Backend("saliency", "motion saliency"),
                Backend("tracks", "dense point tracks that no rigid scene explains"),
                Backend("motion-prompts", "objects outlined and tracked by networks, prompted by moving regions"),
                Backend("detections", "named, found, outlined and tracked objects"),
                Backend("sam3", "objects of your words, found, outlined and tracked by SAM 3 alone"),
                Backend("groundtruth", "annotated objects (an oracle)"),
                Backend("folder", "your own masks"),
            ),
        ),
        Choice(
            "tracker",
            "detections.tracker",
            "--tracker",
            (
                Backend("deaot", "DeAOT", network=DEAOT.network),
                Backend("sam2", "SAM 2.1 video", TRANSFORMERS, SAM2.network, cost_suffix="-video"),
                Backend("edgetam", "EdgeTAM", TRANSFORMERS, EDGETAM.network, cost_suffix="-video"),
                Backend("sam3", "SAM 3", TRANSFORMERS, SAM3.network, cost_suffix="-video"),
            ),
        ),
    ),
)
