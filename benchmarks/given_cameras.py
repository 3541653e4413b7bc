"""Share of tracks that deviate from a rigid scene, with the camera fitted to them or given, in rendered scenes.

Run ``python benchmarks/given_cameras.py [--json FILE]``. The synthetic data set gives exact cameras and depth, as a
network that relates frames estimates them. They are given as they are, or disturbed: each pair's rotation turned about
a random axis, the direction of its translation turned, its length changed, the window's focal length changed, and
inverse depth multiplied by a smooth random map. Tracks are those of the pipeline, so movers are seen as it sees them;
what is counted are tracks of surfaces, over all pairs, whose error exceeds 1.
"""

import argparse
import json
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from moseg.schemas.parameters import DenseTrackParams, RigidityParams
from moseg.tasks.dense_tracks import track_densely
from moseg.tasks.rigidity import GivenCameras, estimate_rigidity
from moseg.tasks.synthetic import SCENES, STILL_SCENES, RenderedScene, Scene, camera_at, render_scene

NUM_FRAMES = 6
MOVING = ("forward-drive-epipolar-car", "drive-oncoming-car", "strong-parallax", "pure-rotation", "static-camera")
STILL = ("rendered-street", "rendered-wall", "rendered-garden", "nothing-moves")
SMOOTHNESS = 40
"""Standard deviation of the blur of the random map, px."""
PARAMS = RigidityParams()
UNCORRECTED = RigidityParams(camera_slip=0, camera_share=0, camera_scale=1, camera_focals=(1.0,))


class Errors(NamedTuple):
    """Standard deviations of what is disturbed: degrees, and shares."""

    rotation: float = 0.0
    direction: float = 0.0
    length: float = 0.0
    focal: float = 0.0
    depth: float = 0.0


class Case(NamedTuple):
    """What rigidity is given: depth or not, cameras or not."""

    errors: Errors = Errors()
    has_depth: bool = True
    has_cameras: bool = True
    params: RigidityParams = PARAMS


SMALL = Errors(0.1, 2, 0.03, 0.02, 0.05)
MEDIUM = Errors(0.3, 5, 0.1, 0.05, 0.1)
LARGE = Errors(1.0, 15, 0.2, 0.1, 0.15)
CASES = {
    "tracks": Case(has_depth=False, has_cameras=False),
    "tracks-depth": Case(has_cameras=False),
    "tracks-depth-medium": Case(MEDIUM, has_cameras=False),
    "exact": Case(),
    "small": Case(SMALL),
    "medium": Case(MEDIUM),
    "large": Case(LARGE),
    "small-uncorrected": Case(SMALL, params=UNCORRECTED),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, help="write the shares here too")
    options = parser.parse_args()
    shares: dict[str, dict[str, list[float]]] = {name: {"movers": [], "static": [], "still": []} for name in CASES}
    for scene_name in (*MOVING, *STILL):
        scene = (SCENES | STILL_SCENES)[scene_name].model_copy(update={"num_frames": NUM_FRAMES})
        rendered = render_scene(scene)
        flows = zip(rendered.flow_forward, rendered.flow_backward, strict=True)
        tracks = track_densely(rendered.images, flows, DenseTrackParams())
        for name, case in CASES.items():
            static, movers = deviating(scene, rendered, tracks, case)
            shares[name]["still" if scene_name in STILL else "static"].append(100 * np.mean(static > 1))
            if scene_name in MOVING:
                shares[name]["movers"].append(100 * np.mean(movers > 1))
            print(f"{scene_name:28} {name:20} static {100 * np.mean(static > 1):5.1f}", flush=True)
    found = {name: {what: float(np.mean(values)) for what, values in each.items()} for name, each in shares.items()}
    print(f"{'deviating tracks, percent':26}" + "".join(f"{what:>10}" for what in ("movers", "static", "still")))
    for name, each in found.items():
        print(f"{name:26}" + "".join(f"{value:10.1f}" for value in each.values()))
    if options.json is not None:
        options.json.write_text(json.dumps(found), encoding="utf-8")


def deviating(scene: Scene, rendered: RenderedScene, tracks, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors of tracks of static and of moving surfaces in all pairs."""
    rng = np.random.default_rng(0)
    cameras = given_cameras(scene, case.errors, rng) if case.has_cameras else None
    maps = [disturb_depth(each, case.errors.depth, rng) for each in rendered.inverse_depth]
    depth_of = maps.__getitem__ if case.has_depth else None
    found = estimate_rigidity(rendered.images, *tracks, case.params, depth_of, cameras=cameras)
    static, moving = [np.empty(0)], [np.empty(0)]
    for (start, gap), error in zip(found.pairs, found.error, strict=True):
        seen = np.flatnonzero(np.isfinite(error))
        (x0, y0), (x1, y1) = (tracks.points[seen, frame].round().astype(int).T for frame in (start, start + gap))
        stays = rendered.objects[start][y0, x0] == rendered.objects[start + gap][y1, x1]
        moves = rendered.moving[start][y0, x0] > 0
        static.append(error[seen][stays & ~moves])
        moving.append(error[seen][stays & moves])
    return np.concatenate(static), np.concatenate(moving)


def given_cameras(scene: Scene, errors: Errors, rng: np.random.Generator) -> GivenCameras:
    """Return the cameras of a scene's frame pairs, with errors."""
    cameras = [camera_at(scene.camera, time, scene.height, scene.width) for time in range(scene.num_frames)]
    poses = {}
    for gap in PARAMS.gaps:
        for start in range(scene.num_frames - gap):
            first, second = cameras[start].pose, cameras[start + gap].pose
            rotation = random_turn(errors.rotation, rng) @ second.rotation.T @ first.rotation
            shift = random_turn(errors.direction, rng) @ second.rotation.T @ (first.translation - second.translation)
            poses[start, gap] = np.column_stack([rotation, shift * np.exp(rng.normal(0, errors.length))])
    focal = cameras[0].focal / max(scene.height, scene.width)
    return GivenCameras(poses, focal * np.exp(rng.normal(0, errors.focal)))


def random_turn(degrees: float, rng: np.random.Generator) -> np.ndarray:
    """Return a rotation by about some degrees about a random axis."""
    return Rotation.from_rotvec(np.radians(degrees) * rng.normal(size=3) / 3**0.5).as_matrix()


def disturb_depth(inverse_depth: np.ndarray, share: float, rng: np.random.Generator) -> np.ndarray:
    """Return inverse depth float32 (y, x) times a smooth random map whose logarithm has a standard deviation."""
    noise = cv2.GaussianBlur(rng.normal(size=inverse_depth.shape), (0, 0), SMOOTHNESS)
    return (inverse_depth * np.exp(share * noise / noise.std())).astype(np.float32)


if __name__ == "__main__":
    main()
