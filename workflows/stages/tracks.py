"""Tracks: points of a section's objects, followed through its frames."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import BootsTapirParams, PipsParams, TrackParams
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.stage import OPENCV, Backend, Choice, Stage
from moseg.workflows.stages.task import Network, Output, Task

LUCAS_KANADE_PARAMS = frozenset({"window", "pyramid_levels", "forward_backward"})


def _run_lucas_kanade(params, inputs, rng):
    from moseg.tasks.tracks import track_points

    frames = (frame.cached("image") for frame in inputs.all("frames"))
    masks = inputs["proposals"].cached("masks")[: params["num_frames"]]
    tracks = track_points(frames, masks, TrackParams.of_recipe(params["tracks"]), rng)
    return Output({"points": tracks.points, "visible": tracks.visible, "object": tracks.object})


def _run_pips(params, inputs, rng):
    from moseg.tasks.networks.pips import build_pips
    from moseg.tasks.tracks.pips import track_points_pips

    frames = (frame.cached("image") for frame in inputs.all("frames"))
    masks = inputs["proposals"].cached("masks")[: params["num_frames"]]
    sampling, network_params = TrackParams.of_recipe(params["tracks"]), PipsParams.of_recipe(params["pips"])
    with open_network(build_pips, inputs["weights"]) as network:
        tracks = track_points_pips(network, frames, masks, sampling, network_params, rng)
    return Output({"points": tracks.points, "visible": tracks.visible, "object": tracks.object}, made_on())


def _run_bootstapir(params, inputs, rng):
    from moseg.tasks.networks.bootstapir import build_bootstapir
    from moseg.tasks.tracks.bootstapir import track_points_bootstapir

    frames = (frame.cached("image") for frame in inputs.all("frames"))
    masks = inputs["proposals"].cached("masks")[: params["num_frames"]]
    sampling, network_params = TrackParams.of_recipe(params["tracks"]), BootsTapirParams.of_recipe(params["bootstapir"])
    with open_network(build_bootstapir, inputs["weights"]) as network:
        tracks = track_points_bootstapir(network, frames, masks, sampling, network_params, rng)
    return Output({"points": tracks.points, "visible": tracks.visible, "object": tracks.object}, made_on())


def _run_given(params, inputs, rng):
    from moseg.tasks.tracks import assign_tracks

    start, stop = params["start"], params["stop"]
    points = inputs["tracks"].cached("points")[:, start:stop]
    visible = inputs["tracks"].cached("visible")[:, start:stop]
    seen = visible.any(axis=1)
    points, visible = points[seen].copy(), visible[seen].copy()
    # The proposals reach into the next section, by more frames than the pairs do.
    masks = inputs["proposals"].cached("masks")[: stop - start]
    return Output({"points": points, "visible": visible, "object": assign_tracks(points, visible, masks)})


def _lucas_kanade_params(config: PipelineConfig, num_frames: int) -> dict:
    return {"num_frames": num_frames, "tracks": config.tracks.model_dump(mode="json", exclude={"method"})}


def _pips_params(config: PipelineConfig, num_frames: int) -> dict:
    return _network_params(config, num_frames, "pips")


def _bootstapir_params(config: PipelineConfig, num_frames: int) -> dict:
    return _network_params(config, num_frames, "bootstapir")


def _network_params(config: PipelineConfig, num_frames: int, network: str) -> dict:
    return {
        "num_frames": num_frames,
        "tracks": config.tracks.model_dump(mode="json", exclude={"method"} | LUCAS_KANADE_PARAMS),
        network: getattr(config, network).model_dump(mode="json", exclude={"weights"}),
    }


def _given_params(config: PipelineConfig, start: int, stop: int) -> dict:
    return {"start": start, "stop": stop}


def _method(config: PipelineConfig) -> str:
    return "given" if config.tracks.method in ("groundtruth", "folder") else config.tracks.method


LUCAS_KANADE = Task("tracks", "lucas-kanade", version=1, run=_run_lucas_kanade, params=_lucas_kanade_params)
PIPS = Task(
    "tracks", "pips", version=2, run=_run_pips, params=_pips_params, network=Network("pips", "pips.weights", "pips")
)
BOOTSTAPIR = Task(
    "tracks",
    "bootstapir",
    version=1,
    run=_run_bootstapir,
    params=_bootstapir_params,
    network=Network("bootstapir", "bootstapir.weights", "bootstapir"),
)
GIVEN_TRACKS = Task("tracks", "given", version=1, run=_run_given, params=_given_params)

STAGE = Stage(
    name="tracks",
    about="point tracks of a section's objects",
    inputs={
        "frames": "frames of the section, and as many of the next as a pair reaches",
        "proposals": "objects of the section",
        "tracks": "given tracks of the sequence (given)",
        "weights": "of the network",
    },
    arrays={
        "points": layout("float32", "track frame xy", "px"),
        "visible": layout("bool", "track frame"),
        "object": layout("uint16", "track", "object of the section"),
    },
    tasks=(LUCAS_KANADE, PIPS, BOOTSTAPIR, GIVEN_TRACKS),
    method=_method,
    choices=(
        Choice(
            "tracks",
            "tracks.method",
            "--tracks",
            (
                Backend("lucas-kanade", "pyramidal Lucas-Kanade", OPENCV),
                Backend("pips", "PIPs", network=PIPS.network),
                Backend("bootstapir", "BootsTAPIR, through occlusions", network=BOOTSTAPIR.network),
                Backend("groundtruth", "exact (synthetic)"),
                Backend("folder", "your own tracks"),
            ),
        ),
    ),
)
