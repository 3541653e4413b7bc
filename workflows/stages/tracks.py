"""Point tracks of a section's objects."""

from moseg.schemas.parameters import PipsParams, TrackParams
from moseg.tasks.tracks import assign_tracks, track_points
from moseg.workflows.stages.resident import made_on, open_network
from moseg.workflows.stages.task import Output, Task


def _run_lucas_kanade(params, inputs, rng):
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


def _run_given(params, inputs, rng):
    start, stop = params["start"], params["stop"]
    points = inputs["tracks"].cached("points")[:, start:stop]
    visible = inputs["tracks"].cached("visible")[:, start:stop]
    seen = visible.any(axis=1)
    points, visible = points[seen].copy(), visible[seen].copy()
    masks = inputs["proposals"].cached("masks")
    return Output({"points": points, "visible": visible, "object": assign_tracks(points, visible, masks)})


LUCAS_KANADE = Task("tracks", "lucas-kanade", version=1, run=_run_lucas_kanade)
PIPS = Task("tracks", "pips", version=2, run=_run_pips)
GIVEN_TRACKS = Task("tracks", "given", version=1, run=_run_given)
